"""What stands in the way of a place: a learned judgement of pairs, from the room between the two.

Whether a dish fits beside another is a matter of geometry, the same for every person and rack. So a
small network sees each place together with each object, and the geometry of the pair alone. It is
given what learning from choices would need long for: the gaps between the two, taken as elliptical
cylinders of their extents, along the axes that can separate them. Two convex bodies are apart if
there is an axis along which they are (Gottschalk et al., 1996). What a cylinder gets wrong about
cups and bowls, it learns.
"""

import torch
import torch.nn.functional as F
from torch import Tensor, nn

from kitchen_prefs.instances import EXTENTS, IS_OBJECT, IS_PLACE, POSITION, QUATERNION

REACH = 0.4  # m; the largest dishes, 36 cm from corner to corner, touch at that distance at most
UNIT = 0.05  # m; what is divided by it is of order one
FEATURES = 6 + 1 + 3 + 3 + 9 + 3 + 3


class Clashes(nn.Module):
    """How much the objects of a set stand in the way of its places."""

    def __init__(self, hidden: int = 32) -> None:
        """Make the network, which begins with nothing in the way."""
        super().__init__()
        last = nn.Linear(hidden, 1)
        nn.init.constant_(last.bias, -3.0)  # softplus(-3) is .05
        self.layers = nn.Sequential(
            nn.Linear(FEATURES, hidden), nn.GELU(), nn.Linear(hidden, hidden), nn.GELU(), last
        )

    def forward(self, sets: Tensor) -> Tensor:
        """Judge the rows of sets.

        Args:
            sets: Sets, zero-padded, (B, N, 13).

        Returns:
            What to subtract from the score of each row, at least 0, and 0 for objects, (B, N).
        """
        places, objects = sets[..., IS_PLACE] > 0, sets[..., IS_OBJECT] > 0
        b, i, j = (places[:, :, None] & objects[:, None]).nonzero(as_tuple=True)  # (K,) each
        near = (sets[b, i, POSITION] - sets[b, j, POSITION]).norm(dim=-1) < REACH
        b, i, j = b[near], i[near], j[near]
        judged = self.layers(pair_features(sets[b, i], sets[b, j]))[:, 0]  # (K,)
        penalties = F.softplus(judged.float())
        return sets.new_zeros(sets.shape[:2]).index_put((b, i), penalties, accumulate=True)


def pair_features(places: Tensor, objects: Tensor) -> Tensor:
    """Describe K pairs of instances by what does not depend on where in the kitchen they are.

    Args:
        places: Rows, (K, 13).
        objects: Rows, (K, 13).

    Returns:
        Gaps along six axes and the largest of them, where each is in the other's frame, how the one
        is turned against the other, and half of the extents of both, (K, FEATURES).
    """
    turn_i, turn_j = rotation(places[:, QUATERNION]), rotation(objects[:, QUATERNION])  # (K, 3, 3)
    half_i, half_j = places[:, EXTENTS] / 2, objects[:, EXTENTS] / 2  # (K, 3)
    offset = places[:, POSITION] - objects[:, POSITION]  # (K, 3)
    axes = _separating_axes(offset, turn_i[..., 2], turn_j[..., 2])  # (K, A, 3)
    between = torch.einsum("kax,kx->ka", axes, offset).abs()
    gaps = between - _support(axes, turn_i, half_i) - _support(axes, turn_j, half_j)  # (K, A)
    in_units = torch.cat(
        [
            gaps,
            gaps.amax(dim=1, keepdim=True),
            torch.einsum("kxy,kx->ky", turn_i, offset),
            torch.einsum("kxy,kx->ky", turn_j, offset),
            half_i,
            half_j,
        ],
        dim=1,
    )
    turned = torch.einsum("kxy,kxz->kyz", turn_i, turn_j).flatten(1)  # (K, 9)
    return torch.cat([in_units / UNIT, turned], dim=1)


def rotation(quaternions: Tensor) -> Tensor:
    """The rotation matrices of unit quaternions (wxyz), (K, 4) -> (K, 3, 3)."""
    w, x, y, z = quaternions.unbind(dim=-1)
    rows = [
        *(1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)),
        *(2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)),
        *(2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)),
    ]
    return torch.stack(rows, dim=-1).unflatten(-1, (3, 3))


def _separating_axes(offset: Tensor, up_i: Tensor, up_j: Tensor) -> Tensor:
    """Both cylinders' axes, the offset, its part across each axis, and across both, (K, 6, 3)."""
    across_i = offset - (offset * up_i).sum(dim=1, keepdim=True) * up_i
    across_j = offset - (offset * up_j).sum(dim=1, keepdim=True) * up_j
    across_both = torch.linalg.cross(up_i, up_j)
    directions = torch.stack([offset, across_i, across_j, across_both], dim=1)  # (K, 4, 3)
    length = directions.norm(dim=-1, keepdim=True)
    # A direction of no length, of cylinders at one place or upright both, separates nothing new.
    unit = torch.where(length > 1e-4, directions / length.clamp(min=1e-4), up_i[:, None])
    return torch.cat([up_i[:, None], up_j[:, None], unit], dim=1)


def _support(axes: Tensor, turn: Tensor, half: Tensor) -> Tensor:
    """How far elliptical cylinders reach from their centres along axes, (K, A) in m."""
    along = torch.einsum("kax,kxy->kay", axes, turn).abs() * half[:, None]  # (K, A, 3)
    return torch.hypot(along[..., 0], along[..., 1]) + along[..., 2]
