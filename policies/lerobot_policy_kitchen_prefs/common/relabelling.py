"""Relabelling: augments the seven training preferences by permuting the categories.

A permutation of the categories, applied to prompt and situation together, turns a preference into
another preference of the same task. So the network sees thousands of preferences instead of seven,
and learns to read the prompt instead of memorising the seven.

A category shows in the extents and in the pose. A relabelled dish takes the extents of its new
category; on the counter its height follows from them, and in a rack it takes a pose that
demonstrations gave to the new category there. An unchanged pose would give the old category away.
Dishes are moved independently and may overlap, which pick decisions do not depend on; where no
demonstration put such a dish into that rack, the pose is kept.

Place decisions keep their categories, because a placement fits only one category; and in a
demonstration they do not depend on the preference, but on the rack that is out and its dishes.
"""

import numpy as np
import torch
from torch import Tensor

from kitchen_prefs.instances import EXTENTS, POSE, POSITION, is_place_decision
from kitchen_prefs.simulation.layout import COUNTER_HEIGHT

from .categories import Categories
from .dish_locations import on_counter
from .rack_poses import RackPoses

HEIGHT = EXTENTS.stop - 1  # the columns of the vertical extent and of the vertical position
ELEVATION = POSITION.stop - 1


def relabel(
    prompts: Tensor,
    sets: Tensor,
    prompt_of: Tensor,
    categories: Categories,
    rack_poses: RackPoses,
    generator: np.random.Generator,
) -> tuple[Tensor, Tensor]:
    """Relabel each prompt by a permutation of its own, and its pick situations by the same.

    Args:
        prompts: Demonstrations, observed without noise, (G, P, 14).
        sets: Situations, observed without noise, (S, N, 13).
        prompt_of: The prompt of each situation, (S,) int64.
        categories: The categories to permute.
        rack_poses: The poses of each category in the racks.
        generator: Source of randomness.

    Returns:
        The prompts and the situations, relabelled.
    """
    identity = np.tile(np.arange(len(categories)), (len(prompts), 1))
    permutations = torch.from_numpy(generator.permuted(identity, axis=1)).to(sets.device)

    def permute(rows: Tensor, permutations: Tensor) -> Tensor:  # (B, N, D), (B, C) -> (B, N, D)
        old, has_category = categories.find(rows)  # (B, N) each
        new = permutations.gather(1, old)  # (B, N)
        relabelled = rows.clone()
        relabelled[..., EXTENTS] = categories.extents.to(rows.device)[new]
        relabelled[..., POSE] = rack_poses.draw(rows, new, generator)
        upright = COUNTER_HEIGHT + relabelled[..., HEIGHT] / 2  # (B, N)
        relabelled[..., ELEVATION] = upright.where(on_counter(rows), relabelled[..., ELEVATION])
        return relabelled.where(has_category[..., None], rows)

    is_pick = ~is_place_decision(sets)  # (S,)
    relabelled = sets.clone()
    relabelled[is_pick] = permute(sets[is_pick], permutations[prompt_of[is_pick]])
    return permute(prompts, permutations), relabelled
