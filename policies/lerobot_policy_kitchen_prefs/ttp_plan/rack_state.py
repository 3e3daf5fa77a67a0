"""Which rack is out, and what stands in both, as far as it was seen in the episode."""

import torch
from torch import Tensor

from kitchen_prefs.envs.observations import RACK_ROWS
from kitchen_prefs.instances import POSE

from .dish_tokens import EXACT, visible_contents

# The poses of both racks when they are out, the top one first, as zones are counted.
OUT = torch.tensor([RACK_ROWS[rack][1][POSE].tolist() for rack in ("top", "bottom")])  # (2, 7)
NEAR = 1e-3  # m; racks move by decimetres


def open_racks(sets: Tensor) -> Tensor:
    """Which racks are out, the top one and the bottom one, in sets (B, N, 21): (B, 2) bool."""
    apart = torch.cdist(sets[..., POSE], OUT.to(sets).expand(len(sets), -1, -1), compute_mode=EXACT)
    return (apart < NEAR).any(dim=1)


class ContentsMemory:
    """What stands in the racks in each of B episodes; a rack that is in hides it."""

    def __init__(self) -> None:
        """Begin with empty racks."""
        self._contents: Tensor | None = None

    def update(self, sets: Tensor) -> Tensor:
        """Look at the present sets, (B, N, 21).

        Returns:
            How many dishes of each category stand in each zone, (B, 4, 7). A dish never leaves a
            rack, so it is the most that was seen.
        """
        seen = visible_contents(sets)
        self._contents = seen if self._contents is None else torch.maximum(self._contents, seen)
        return self._contents
