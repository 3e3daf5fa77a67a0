"""Relabelling: one permutation of the categories, applied to prompt and situation together.

Who loads cups as others load plates holds another preference of the same task. So seven
preferences become as many as there are permutations, and the network learns to read the prompt
instead of knowing the seven by heart.

A category is its extents. A relabelled dish takes those of its new category, and on the counter it
stands as high as they make it. In a rack it keeps its pose. Place decisions keep their categories,
because a placement fits one category alone; and in a demonstration they do not depend on the
preference, but on the rack that is out and on what stands in it.
"""

import numpy as np
import torch
from torch import Tensor

from kitchen_prefs.instances import EXTENTS, IS_OBJECT, IS_PLACE, POSITION
from kitchen_prefs.scene.layout import COUNTER_HEIGHT

from .demonstrations import Demonstrations
from .pairing import Pairs
from .sets import is_place_decision

HEIGHT = EXTENTS.stop - 1  # the columns of the vertical extent and of the vertical position
ELEVATION = POSITION.stop - 1
TOLERANCE = 1e-4  # m: below every difference between two dishes, above the rounding of float32


class Relabelling:
    """The categories of a data set, and how pairs change when they are permuted."""

    def __init__(self, demonstrations: Demonstrations) -> None:
        """Find the categories: the extents of what can be placed.

        Args:
            demonstrations: Those of the data set that is trained on.
        """
        rows = demonstrations.rows
        extents = np.unique(rows[rows[:, IS_PLACE] > 0][:, EXTENTS], axis=0)
        self.extents = torch.from_numpy(extents)  # (C, 3)

    def __call__(self, pairs: Pairs, generator: np.random.Generator) -> Pairs:
        """Relabel each prompt by a permutation of its own, and its pick situations by the same."""
        identity = np.tile(np.arange(len(self.extents)), (len(pairs.prompts), 1))
        permutations = torch.from_numpy(generator.permuted(identity, axis=1)).to(pairs.sets.device)
        is_pick = ~is_place_decision(pairs.sets)  # (S,)
        sets = pairs.sets.clone()
        sets[is_pick] = self._apply(sets[is_pick], permutations[pairs.prompt_of[is_pick]])
        return pairs._replace(prompts=self._apply(pairs.prompts, permutations), sets=sets)

    def _apply(self, rows: Tensor, permutations: Tensor) -> Tensor:
        """Relabel sets, (B, N, D), by permutations of the categories, (B, C)."""
        categories = self.extents.to(rows.device)
        difference = (rows[..., None, EXTENTS] - categories).abs().amax(dim=-1)  # (B, N, C)
        nearest, category = difference.min(dim=-1)  # (B, N)
        is_dish = nearest < TOLERANCE
        extents = categories[permutations.gather(1, category)]  # (B, N, 3)
        bottom = rows[..., ELEVATION] - rows[..., HEIGHT] / 2
        on_counter = is_dish & ((bottom - COUNTER_HEIGHT).abs() < TOLERANCE)
        on_counter &= rows[..., IS_OBJECT] > 0
        relabelled = rows.clone()
        relabelled[..., EXTENTS] = extents.where(is_dish[..., None], rows[..., EXTENTS])
        standing = COUNTER_HEIGHT + extents[..., 2] / 2
        relabelled[..., ELEVATION] = standing.where(on_counter, rows[..., ELEVATION])
        return relabelled
