"""What stands in the way of a place: every category has a shape, and two shapes clash or do not.

Whether a dish fits beside another is a matter of their shapes, the same for every person and rack.
So the network learns a shape of 25 spheres for the extents of each category, and the gaps between
the shape of a place and those of the dishes around it say how probably it is blocked. No
demonstration shows a shape, but every choice shows gaps: the chosen place was free, and those
nearer to the rack's corner were not. A shape that was learned beside cups holds beside plates, so
the row_scores carries over to categories that never shared a rack in training.
"""

import torch
import torch.nn.functional as F
from torch import Tensor, nn

from kitchen_prefs.instances import EXTENTS, IS_PLACE, POSITION, QUATERNION

from .instance_sets import LARGEST_DISH, is_dish, is_place_decision, is_real

# m; two of the largest dishes touch at that distance at most. The door and the racks are not in the
# way.
REACH = LARGEST_DISH
SHARPNESS = 500.0  # 1 / m; shapes that share 2 mm clash with a probability of .73
# A shape starts as the wall and the bottom of an elliptical cylinder: the radius and the height of
# rings of six spheres, in halves of the extents.
RINGS = ((0.9, -0.9), (0.9, 0.0), (0.9, 0.9), (0.45, -0.9))
# Of the shapes' learning, which else lags behind; saved weights are multiplied by it, too.
PACE = 6.0
WALL = 0.004  # m; the radius of the spheres, as dishes are some 8 mm thick


class CollisionModel(nn.Module):
    """How probably the dishes of a set leave its places free."""

    cylinder: Tensor

    def __init__(self, hidden: int = 64) -> None:
        """Make the network from extents to shapes, which begins with cylinders."""
        super().__init__()
        self.register_buffer("cylinder", _cylinder(), persistent=False)  # (K, 3)
        last = nn.Linear(hidden, 4 * len(self.cylinder))
        nn.init.normal_(last.weight, std=0.01 / PACE)
        nn.init.zeros_(last.bias)
        self.layers = nn.Sequential(nn.Linear(3, hidden), nn.GELU(), last)

    def forward(self, sets: Tensor) -> Tensor:
        """Judge the rows of sets.

        Args:
            sets: Sets, zero-padded, (B, N, 13).

        Returns:
            The log-probability that nothing blocks a row, 0 for what is no place, (B, N).
        """
        places = sets[..., IS_PLACE] > 0  # (B, N)
        dishes = is_dish(sets)  # (B, N)
        near = torch.cdist(sets[..., POSITION], sets[..., POSITION]) < REACH  # (B, N, N)
        b, i, j = (places[:, :, None] & dishes[:, None] & near).nonzero(as_tuple=True)  # (M,) each
        centres, radii = self._shapes(sets)
        gaps = smallest_gaps(centres[b, i], radii[b, i], centres[b, j], radii[b, j])  # (M,)
        fits = F.logsigmoid(SHARPNESS * gaps)
        return sets.new_zeros(sets.shape[:2]).index_put((b, i), fits, accumulate=True)

    def _shapes(self, sets: Tensor) -> tuple[Tensor, Tensor]:
        """The spheres of all rows: centres in the kitchen, (B, N, K, 3), and radii, (B, N, K)."""
        extents = sets[..., EXTENTS]
        learned = PACE * self.layers(extents * 10).unflatten(-1, (-1, 4))  # (B, N, K, 4)
        in_halves = self.cylinder + learned[..., :3].tanh() / 2  # (B, N, K, 3)
        turns = rotation(sets[..., QUATERNION])  # (B, N, 3, 3)
        centres = torch.einsum("bnxy,bnky->bnkx", turns, in_halves * extents[..., None, :] / 2)
        return sets[..., None, POSITION] + centres, WALL * learned[..., 3].clamp(max=2).exp()


def attended_rows(sets: Tensor) -> Tensor:
    """Which rows, (B, N, 13), a network looks at beside `CollisionModel`, (B, N) bool.

    Where places are chosen, clashes alone judge objects. Attention that saw them, too, would know
    by heart which dishes of the training preferences bar which places.
    """
    is_place_set = is_place_decision(sets)[:, None]  # (B, 1)
    return (sets[..., IS_PLACE] > 0).where(is_place_set, is_real(sets))


def smallest_gaps(a: Tensor, a_radii: Tensor, b: Tensor, b_radii: Tensor) -> Tensor:
    """The gap between the two nearest spheres of M pairs of shapes, negative where they overlap.

    Args:
        a: The centres of the one, (M, K, 3), in m.
        a_radii: Their radii, (M, K), in m.
        b: The centres of the other, (M, K, 3).
        b_radii: Their radii, (M, K).

    Returns:
        The gaps in m, (M,). Only the two nearest spheres have a gradient.
    """
    with torch.no_grad():
        gaps = torch.cdist(a, b) - a_radii[:, :, None] - b_radii[:, None]  # (M, K, K)
        nearest = gaps.flatten(1).argmin(dim=1)  # (M,)
    pair, i, j = torch.arange(len(a), device=a.device), nearest // a.shape[1], nearest % a.shape[1]
    return (a[pair, i] - b[pair, j]).norm(dim=-1) - a_radii[pair, i] - b_radii[pair, j]


def rotation(quaternions: Tensor) -> Tensor:
    """The rotation matrices of unit quaternions (wxyz), (..., 4) -> (..., 3, 3)."""
    w, x, y, z = quaternions.unbind(dim=-1)
    rows = [
        *(1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)),
        *(2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)),
        *(2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)),
    ]
    return torch.stack(rows, dim=-1).unflatten(-1, (3, 3))


def _cylinder() -> Tensor:
    """Where the spheres of a shape begin, in halves of the extents, (K, 3)."""
    angles = torch.arange(6) * torch.pi / 3
    rings = [
        torch.stack([r * angles.cos(), r * angles.sin(), torch.full_like(angles, z)], dim=1)
        for r, z in RINGS
    ]
    return torch.cat([*rings, torch.tensor([[0.0, 0.0, -0.9]])])
