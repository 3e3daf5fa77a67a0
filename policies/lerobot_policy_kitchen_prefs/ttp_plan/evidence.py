"""What demonstrations say of a dish, counted head by head.

For each head, which looks at the dishes that have an attribute in common with one: where these were
put, how often they were preferred to others, and how well that attribute explains all that was
shown.
"""

from typing import NamedTuple

import torch
from torch import Tensor

from .match_attention import HEADS

DOUBT = 0.5  # as much as half a dish: shares of few dishes are smaller
PER_HEAD = 5 + 1 + 1 + 2 + 2  # destinations, how many, own destination, preferences, explanations
EVIDENCE = len(HEADS) * PER_HEAD


class Shown(NamedTuple):
    """What was shown to G users' readers.

    Attributes:
        destinations: Where each dish was put, one of five, (G, n, 5).
        preferred: Where a dish was picked while another of its rack waited, (G, n, n).
        explained: How well each head explains destinations and preferences, (G, h, 2).
    """

    destinations: Tensor
    preferred: Tensor
    explained: Tensor


def shown(alike: Tensor, destinations: Tensor, preferred: Tensor, mask: Tensor) -> Shown:
    """Find out how well each head explains what was shown.

    Args:
        alike: How far pairs are alike for each head, without those of padding, (G, h, n, n).
        destinations: (G, n, 5).
        preferred: (G, n, n).
        mask: Which dishes are real, (G, n) bool.
    """
    where = to_others(alike) @ destinations[:, None]  # (G, h, n, 5)
    own = (where * destinations[:, None]).sum(-1) / (where.sum(-1) + DOUBT)  # (G, h, n)
    of_destinations = (own * mask[:, None]).sum(-1) / mask.sum(-1)[:, None].clamp(min=1)
    agreeing = alike @ preferred[:, None] @ alike.mT  # (G, h, n, n)
    agreement = agreeing / (agreeing + agreeing.mT + DOUBT)
    of_preferences = (preferred[:, None] * agreement).sum((2, 3))
    of_preferences = of_preferences / preferred.sum((1, 2))[:, None].clamp(min=1)
    explained = torch.stack([of_destinations, of_preferences], dim=-1)  # (G, h, 2)
    return Shown(destinations, preferred, explained)


def to_others(alike: Tensor) -> Tensor:
    """How far dishes are like others, (..., n, n): zero for each and itself."""
    return alike * (1 - torch.eye(alike.shape[-1], device=alike.device))


def evidence(alike: Tensor, known: Shown, own: Tensor | None = None) -> Tensor:
    """What was shown says of dishes.

    Args:
        alike: How far they are like those that were shown, for each head, (B, h, m, n).
        known: What was shown, of B users.
        own: Where the dishes were put, if they were shown themselves, (B, m, 5).

    Returns:
        (B, m, EVIDENCE).
    """
    where = alike @ known.destinations[:, None]  # (B, h, m, 5)
    count = where.sum(-1, keepdim=True)  # (B, h, m, 1)
    wins = alike @ known.preferred.sum(2)[:, None, :, None]  # (B, h, m, 1)
    losses = alike @ known.preferred.sum(1)[:, None, :, None]
    to_own = torch.zeros_like(count) if own is None else (where * own[:, None]).sum(-1, True)
    explained = known.explained[:, :, None].expand(-1, -1, alike.shape[2], -1)  # (B, h, m, 2)
    parts = [
        *(where / (count + DOUBT), count.log1p(), to_own / (count + DOUBT)),
        *(wins / (wins + losses + 1), losses / (wins + losses + 1), explained),
    ]
    return torch.cat(parts, dim=-1).transpose(1, 2).flatten(2)
