"""From a whole demonstration to the rows of a prompt's tokens.

A demonstration has a row for each instance of each decision (see `kitchen_prefs.instances`). The
paper's tokens are all of them, with an ACT token (A) after each decision's set:

    [ set of decision 0 ] A [ set of decision 1 ] A ... [ set of decision T-1 ] A

The compact tokens are the chosen rows, which the paper leaves out:

    [ chosen row 0 ] [ chosen row 1 ] ... [ chosen row T-1 ]

The final tokens are the dishes in each rack when it was last visible, without order and time: the
information that the final arrangement has about a preference.

    [ dish in the bottom rack ] ... [ dish in the top rack ] ...
"""

import torch
import torch.nn.functional as F
from torch import Tensor

from kitchen_prefs.instances import (
    DECISION,
    DESCRIBED_COLUMNS,
    PEOPLE_PROMPT_CAPACITY,
    PROMPT_CAPACITY,
    is_real,
)

from ..common.dish_locations import in_rack, in_top_rack
from ..common.instance_sets import is_dish, select_rows


def tokens_of_prompts(prompts: Tensor, kind: str) -> tuple[Tensor, Tensor]:
    """Choose and arrange the rows that become tokens.

    Args:
        prompts: Demonstrations, zero-padded, (G, P, D + 1).
        kind: "states", "chosen" or "final".

    Returns:
        The tokens' rows, (G, L, D), and which of them are real, (G, L) bool.
    """
    if kind == "chosen":
        rows, mask = select_rows(prompts, is_real(prompts) & (prompts[..., -1] > 0))
        return rows[..., :-1], mask
    if kind == "final":
        rows, mask = select_rows(prompts[..., :-1], in_the_end(prompts))
        return rows.index_fill(-1, torch.tensor([DECISION], device=rows.device), 0), mask
    return _with_act_tokens(*select_rows(prompts[..., :-1], is_real(prompts)))


def in_the_end(prompts: Tensor) -> Tensor:
    """Which rows are dishes in a rack at the last decision at which that rack was visible.

    Args:
        prompts: Demonstrations, zero-padded, (G, P, D + 1).

    Returns:
        A mask, (G, P) bool. A dish never leaves a rack, so the last decision with dishes of a rack
        has all of them.
    """
    racked, top = is_dish(prompts) & in_rack(prompts), in_top_rack(prompts)  # (G, P) each
    last = torch.zeros_like(racked)
    for in_this in (racked & ~top, racked & top):
        decision = prompts[..., DECISION].where(in_this, -1)  # (G, P)
        last |= in_this & (decision == decision.amax(dim=1, keepdim=True))
    return last


def split_prompts(prompts: Tensor) -> Tensor:
    """Split prompts of V demonstrations each, (B, V P, D + 1) -> (B V, P, D + 1).

    Raises:
        ValueError: If their length is not that of whole demonstrations.
    """
    described = prompts.shape[-1] == DESCRIBED_COLUMNS + 1
    whole = PEOPLE_PROMPT_CAPACITY if described else PROMPT_CAPACITY
    capacity = min(whole, prompts.shape[1])
    if prompts.shape[1] % capacity:
        raise ValueError(
            f"A prompt of several demonstrations has a multiple of {whole} rows, not "
            f"{prompts.shape[1]}; take it from the environment."
        )
    return prompts.unflatten(1, (-1, capacity)).flatten(0, 1)


def _with_act_tokens(rows: Tensor, mask: Tensor) -> tuple[Tensor, Tensor]:
    """Put a row of zeros after each decision's rows, (G, M, D), of which `mask` are real."""
    begins = (rows[:, 1:, DECISION] != rows[:, :-1, DECISION]) & mask[:, 1:]  # (G, M - 1)
    acts_before = F.pad(begins.cumsum(dim=1), (1, 0))  # (G, M)
    length = rows.shape[1] + int(acts_before.max()) + 1
    target = torch.arange(rows.shape[1], device=rows.device) + acts_before  # (G, M)
    target = target.where(mask, length)  # padding goes to a last row, which is cut off
    tokens = rows.new_zeros(len(rows), length + 1, rows.shape[-1])
    tokens.scatter_(1, target[..., None].expand_as(rows), rows)
    real = mask.sum(dim=1) + acts_before.amax(dim=1) + 1  # (G,)
    return tokens[:, :length], torch.arange(length, device=rows.device) < real[:, None]
