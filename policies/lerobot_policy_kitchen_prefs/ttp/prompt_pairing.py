"""Prompt-situation pairs: one prompt for each preference of a batch, shared by its situations.

The paper's objective (section 2.2) prompts all situations of a preference with one demonstration.
So a batch has a handful of prompts, and each is encoded once. Further rounds pair the same pick
decisions with other prompts, without loading more samples. Place decisions need only one round: in
a demonstration, the preference determines what is picked, and the rack determines the place.

                 round 0              round 1
    sample       0  1  2 ... B - 1    0  2 ...      (1 is a place decision)
    prompt_of    0  1  0 ... 2        3  3 ...      (three preferences in the batch)
"""

from typing import NamedTuple

import numpy as np
import torch
from torch import Tensor

from kitchen_prefs.datasets.demonstration_store import DemonstrationStore
from kitchen_prefs.instances import is_place_decision


class Pairs(NamedTuple):
    """Situations and their prompts.

    Attributes:
        prompts: Demonstrations, zero-padded, (G, P, 14).
        sets: The situations, zero-padded, (S, N, 13).
        targets: The row that the expert chose in each situation, (S,) int64.
        prompt_of: The prompt of each situation, (S,) int64.
        sample: The index in the batch of each situation's sample, (S,) int64.
    """

    prompts: Tensor
    sets: Tensor
    targets: Tensor
    prompt_of: Tensor
    sample: Tensor


def make_pairs(
    sets: Tensor,
    targets: Tensor,
    episodes: np.ndarray,
    demonstrations: DemonstrationStore,
    rounds: int,
    generator: np.random.Generator,
) -> Pairs:
    """Pair a batch's samples with prompts of the same preference from other sessions.

    Args:
        sets: The samples' sets, (B, N, 13).
        targets: The rows that the expert chose, (B,) int64.
        episodes: The episode of each sample, (B,) int.
        demonstrations: The demonstrations to draw prompts from.
        rounds: The number of prompts for each pick decision.
        generator: Source of randomness.

    Returns:
        The pairs: all B samples in the first round, only the pick decisions in the others.
    """
    labels, label_of = np.unique(demonstrations.preference[episodes], return_inverse=True)
    drawn = [
        demonstrations.draw(label, episodes, generator) for _ in range(rounds) for label in labels
    ]
    samples = torch.arange(len(sets), device=sets.device)
    picks = samples[~is_place_decision(sets)]
    sample = torch.cat([samples, picks.repeat(rounds - 1)])  # (S,)
    later = torch.arange(1, rounds, device=sets.device).repeat_interleave(len(picks))
    round_of = torch.cat([torch.zeros_like(samples), later])  # (S,)
    return Pairs(
        prompts=torch.from_numpy(demonstrations.prompts(drawn)).to(sets.device),
        sets=sets[sample],
        targets=targets[sample],
        prompt_of=torch.from_numpy(label_of).to(sets.device)[sample] + len(labels) * round_of,
        sample=sample,
    )
