"""Relabelling: other people of the same task, made of the seven that training knows.

Who loads cups as others load plates holds another preference of the same task. So a permutation of
the categories, applied to prompt and situation together, turns seven preferences into thousands,
and the network learns to read the prompt instead of knowing the seven by heart.

A category is its extents and where it stands. A relabelled dish takes the extents of its new
category; on the counter it stands as high as they make it, and in a rack as demonstrations stood
such dishes there. If it kept its pose, the pose would tell the old category, and the network would
know the seven preferences by heart after all. Dishes are moved one by one and may overlap, which
pick decisions do not mind; where no demonstration put such a dish into that rack, the pose is kept.
Place decisions keep their categories, because a placement fits one category alone; and in a
demonstration they do not depend on the preference, but on the rack that is out and on what stands
in it.
"""

import numpy as np
import torch
from torch import Tensor

from kitchen_prefs.instances import EXTENTS, IS_OBJECT, POSE, POSITION
from kitchen_prefs.simulation.layout import COUNTER_HEIGHT

from ..common.categories import TOLERANCE, Categories
from ..common.instance_sets import is_place_decision
from .prompt_pairing import Pairs
from .rack_poses import RackPoses

HEIGHT = EXTENTS.stop - 1  # the columns of the vertical extent and of the vertical position
ELEVATION = POSITION.stop - 1


def relabel(
    pairs: Pairs, categories: Categories, stands: RackPoses, generator: np.random.Generator
) -> Pairs:
    """Relabel each prompt by a permutation of its own, and its pick situations by the same.

    Args:
        pairs: Prompts and situations, seen exactly.
        categories: What is permuted.
        stands: Where dishes of each category stand in the racks.
        generator: Source of randomness.

    Returns:
        The pairs, relabelled.
    """
    identity = np.tile(np.arange(len(categories)), (len(pairs.prompts), 1))
    permutations = torch.from_numpy(generator.permuted(identity, axis=1)).to(pairs.sets.device)

    def permute(rows: Tensor, permutations: Tensor) -> Tensor:  # (B, N, D), (B, C) -> (B, N, D)
        old, is_dish = categories.find(rows)  # (B, N)
        new = permutations.gather(1, old)
        relabelled = rows.clone()
        relabelled[..., EXTENTS] = categories.extents.to(rows.device)[new]
        relabelled[..., POSE] = stands.move(rows, new, generator)
        standing = COUNTER_HEIGHT + relabelled[..., HEIGHT] / 2
        relabelled[..., ELEVATION] = standing.where(on_counter(rows), relabelled[..., ELEVATION])
        return relabelled.where(is_dish[..., None], rows)

    is_pick = ~is_place_decision(pairs.sets)  # (S,)
    sets = pairs.sets.clone()
    sets[is_pick] = permute(sets[is_pick], permutations[pairs.prompt_of[is_pick]])
    return pairs._replace(prompts=permute(pairs.prompts, permutations), sets=sets)


def on_counter(rows: Tensor) -> Tensor:
    """Which objects, (..., D), stand on the counter, (...) bool."""
    bottom = rows[..., ELEVATION] - rows[..., HEIGHT] / 2
    return (rows[..., IS_OBJECT] > 0) & ((bottom - COUNTER_HEIGHT).abs() < TOLERANCE)
