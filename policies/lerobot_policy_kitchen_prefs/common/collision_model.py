"""Which places are blocked: every category has a learned shape, and shapes collide or do not.

Whether a dish fits beside another is a matter of their shapes, the same for every user and rack. So
the network learns a shape of 25 spheres from the extents of each category, and the signed distances
between the shape of a place and those of the dishes around it give the probability that the place
is free. No demonstration shows a shape, but every choice is evidence: the chosen place was free,
and those nearer to the rack's corner were not. A shape that was learned beside cups holds beside
plates, so the prediction carries over to categories that never shared a rack in training.
"""

import torch
import torch.nn.functional as F
from torch import Tensor, nn

from kitchen_prefs.instances import (
    EXTENTS,
    IS_PLACE,
    POSITION,
    QUATERNION,
    is_place_decision,
    is_real,
)

from .instance_sets import is_dish

# m; two of the largest dishes touch at that distance at most. The door and the racks block nothing.
REACH = 0.4
SHARPNESS = 500.0  # 1 / m; shapes that overlap by 2 mm collide with a probability of .73
# A shape is initialised as the wall and the bottom of an elliptical cylinder: the radius and the
# height of rings of six spheres, in halves of the extents.
RINGS = ((0.9, -0.9), (0.9, 0.0), (0.9, 0.9), (0.45, -0.9))
# Multiplies the layers' output, so that shapes learn as fast as the rest; checkpoints rely on it.
OUTPUT_SCALE = 6.0
SPHERE_RADIUS = 0.004  # m, at initialisation, as dishes are some 8 mm thick


class CollisionModel(nn.Module):
    """The probability that the dishes of a set leave its places free."""

    cylinder: Tensor  # (K, 3), the initial centres of a shape's K spheres

    def __init__(self, hidden: int = 64) -> None:
        """Make the network from extents to shapes, which are cylinders at first.

        Args:
            hidden: The hidden size of the network.
        """
        super().__init__()
        self.register_buffer("cylinder", _cylinder(), persistent=False)
        last = nn.Linear(hidden, 4 * len(self.cylinder))
        nn.init.normal_(last.weight, std=0.01 / OUTPUT_SCALE)
        nn.init.zeros_(last.bias)
        self.layers = nn.Sequential(nn.Linear(3, hidden), nn.GELU(), last)

    def forward(self, sets: Tensor) -> Tensor:
        """Predict which places are free.

        Args:
            sets: Sets, zero-padded, (B, N, 13).

        Returns:
            The log-probability that no dish blocks a row, 0 for rows that are no places, (B, N).
        """
        places = sets[..., IS_PLACE] > 0  # (B, N)
        dishes = is_dish(sets)  # (B, N)
        near = torch.cdist(sets[..., POSITION], sets[..., POSITION]) < REACH  # (B, N, N)
        b, i, j = (places[:, :, None] & dishes[:, None] & near).nonzero(as_tuple=True)  # (M,) each
        centres, radii = self._shapes(sets)
        distances = signed_distances(centres[b, i], radii[b, i], centres[b, j], radii[b, j])  # (M,)
        log_free = F.logsigmoid(SHARPNESS * distances)  # (M,)
        return sets.new_zeros(sets.shape[:2]).index_put((b, i), log_free, accumulate=True)

    def _shapes(self, sets: Tensor) -> tuple[Tensor, Tensor]:
        """The spheres of all rows: centres in the kitchen, (B, N, K, 3), and radii, (B, N, K)."""
        extents = sets[..., EXTENTS]
        learned = OUTPUT_SCALE * self.layers(extents * 10).unflatten(-1, (-1, 4))  # (B, N, K, 4)
        in_halves = self.cylinder + learned[..., :3].tanh() / 2  # (B, N, K, 3)
        rotation = rotation_matrices(sets[..., QUATERNION])  # (B, N, 3, 3)
        centres = torch.einsum("bnxy,bnky->bnkx", rotation, in_halves * extents[..., None, :] / 2)
        radii = SPHERE_RADIUS * learned[..., 3].clamp(max=2).exp()  # (B, N, K)
        return sets[..., None, POSITION] + centres, radii


def attended_rows(sets: Tensor) -> Tensor:
    """The rows that a network with a `CollisionModel` attends to.

    Where places are chosen, only the collision model sees objects. Attention to them would memorise
    which dishes of the training preferences block which places.

    Args:
        sets: Sets, (B, N, 13).

    Returns:
        A mask, (B, N) bool.
    """
    is_place_set = is_place_decision(sets)[:, None]  # (B, 1)
    return (sets[..., IS_PLACE] > 0).where(is_place_set, is_real(sets))


def signed_distances(a: Tensor, a_radii: Tensor, b: Tensor, b_radii: Tensor) -> Tensor:
    """The signed distance of M pairs of shapes, negative where they overlap.

    Args:
        a: The centres of the first shapes' spheres, (M, K, 3), in m.
        a_radii: Their radii, (M, K), in m.
        b: The centres of the second shapes' spheres, (M, K, 3).
        b_radii: Their radii, (M, K).

    Returns:
        The distances between the nearest spheres in m, (M,). Only these have a gradient.
    """
    with torch.no_grad():
        distances = torch.cdist(a, b) - a_radii[:, :, None] - b_radii[:, None]  # (M, K, K)
        nearest = distances.flatten(1).argmin(dim=1)  # (M,)
    pair, i, j = torch.arange(len(a), device=a.device), nearest // a.shape[1], nearest % a.shape[1]
    return (a[pair, i] - b[pair, j]).norm(dim=-1) - a_radii[pair, i] - b_radii[pair, j]


def rotation_matrices(quaternions: Tensor) -> Tensor:
    """The rotation matrices of unit quaternions (wxyz), (..., 4) -> (..., 3, 3)."""
    w, x, y, z = quaternions.unbind(dim=-1)
    rows = [
        *(1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)),
        *(2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)),
        *(2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)),
    ]
    return torch.stack(rows, dim=-1).unflatten(-1, (3, 3))


def _cylinder() -> Tensor:
    """The initial centres of a shape's spheres, in halves of the extents, (K, 3)."""
    angles = torch.arange(6) * torch.pi / 3
    rings = [
        torch.stack([r * angles.cos(), r * angles.sin(), torch.full_like(angles, z)], dim=1)
        for r, z in RINGS
    ]
    return torch.cat([*rings, torch.tensor([[0.0, 0.0, -0.9]])])
