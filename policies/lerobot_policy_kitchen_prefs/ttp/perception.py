"""Noisy sight in training: dishes a little larger or smaller and elsewhere than they are."""

import numpy as np
import torch

from kitchen_prefs.instances import EXTENTS, IS_OBJECT, POSITION
from kitchen_prefs.observations import EXTENT_NOISE, POSITION_NOISE

from .categories import Categories
from .pairing import Pairs


def see_noisily(
    pairs: Pairs, share: float, categories: Categories, generator: np.random.Generator
) -> Pairs:
    """Err about the dishes of some situations, as much as on the split `noisy`.

    Args:
        pairs: Prompts and situations, seen exactly.
        share: The share of situations with errors.
        categories: The categories of dishes.
        generator: Source of randomness.

    Returns:
        The pairs with other situations. The places for a dish share one error of its extents.
    """
    sets = pairs.sets.clone()
    is_dish = categories.find(sets)[1]  # (S, N)
    noisy = torch.from_numpy(generator.random(len(sets)) < share).to(sets.device)  # (S,)
    errors = generator.standard_normal((2, *sets.shape[:2], 3), dtype=np.float32)
    of_extents, of_position = torch.from_numpy(errors).to(sets.device)  # (S, N, 3) each
    is_object = sets[..., IS_OBJECT] > 0
    # A set does not say which dish is in the hand, so the places have an error of their own.
    of_places = of_extents[:, :1].expand_as(of_extents)
    of_extents = of_extents.where(is_object[..., None], of_places)
    seen = (is_dish & noisy[:, None])[..., None]
    sets[..., EXTENTS] *= 1 + EXTENT_NOISE * of_extents * seen
    sets[..., POSITION] += POSITION_NOISE * of_position * (seen & is_object[..., None])
    return pairs._replace(sets=sets)
