"""Relabelling: other people of the same task, made of the seven that training knows.

Who loads cups as others load plates holds another preference of the same task. So a permutation of
the categories, applied to prompt and situation together, turns seven preferences into thousands,
and the network learns to read the prompt instead of knowing the seven by heart.

A category is its extents. A relabelled dish takes those of its new category, and on the counter it
stands as high as they make it. In a rack it keeps its pose. Place decisions keep their categories,
because a placement fits one category alone; and in a demonstration they do not depend on the
preference, but on the rack that is out and on what stands in it.
"""

import numpy as np
import torch
from torch import Tensor

from kitchen_prefs.instances import EXTENTS, IS_OBJECT, POSITION
from kitchen_prefs.scene.layout import COUNTER_HEIGHT

from .categories import TOLERANCE, Categories
from .pairing import Pairs
from .sets import is_place_decision

HEIGHT = EXTENTS.stop - 1  # the columns of the vertical extent and of the vertical position
ELEVATION = POSITION.stop - 1


def relabel(pairs: Pairs, categories: Categories, generator: np.random.Generator) -> Pairs:
    """Relabel each prompt by a permutation of its own, and its pick situations by the same.

    Args:
        pairs: Prompts and situations, seen exactly.
        categories: What is permuted.
        generator: Source of randomness.

    Returns:
        The pairs, relabelled.
    """
    identity = np.tile(np.arange(len(categories)), (len(pairs.prompts), 1))
    permutations = torch.from_numpy(generator.permuted(identity, axis=1)).to(pairs.sets.device)
    is_pick = ~is_place_decision(pairs.sets)  # (S,)
    sets = pairs.sets.clone()
    sets[is_pick] = _permute(sets[is_pick], permutations[pairs.prompt_of[is_pick]], categories)
    return pairs._replace(prompts=_permute(pairs.prompts, permutations, categories), sets=sets)


def _permute(rows: Tensor, permutations: Tensor, categories: Categories) -> Tensor:
    """Relabel sets, (B, N, D), by permutations of the categories, (B, C)."""
    category, is_dish = categories.find(rows)  # (B, N)
    extents = categories.extents.to(rows.device)[permutations.gather(1, category)]  # (B, N, 3)
    bottom = rows[..., ELEVATION] - rows[..., HEIGHT] / 2
    on_counter = is_dish & ((bottom - COUNTER_HEIGHT).abs() < TOLERANCE)
    on_counter &= rows[..., IS_OBJECT] > 0
    relabelled = rows.clone()
    relabelled[..., EXTENTS] = extents.where(is_dish[..., None], rows[..., EXTENTS])
    standing = COUNTER_HEIGHT + extents[..., 2] / 2
    relabelled[..., ELEVATION] = standing.where(on_counter, rows[..., ELEVATION])
    return relabelled
