"""From a whole demonstration to the rows of a prompt's tokens.

The demonstration, as `kitchen_prefs.instances` draws it, has a row for each instance of each
decision. The paper's tokens are all of them, with an ACT token (A) after each decision's
set:

    [ set of decision 0 ] A [ set of decision 1 ] A ... [ set of decision T-1 ] A

The compact tokens are the chosen rows alone, which the paper leaves out:

    [ chosen row 0 ] [ chosen row 1 ] ... [ chosen row T-1 ]

The final tokens are the dishes in the racks as each rack was last seen, in no order and without
time: what remains of a preference where only the final arrangement is looked at.

    [ dish in the bottom rack ] ... [ dish in the top rack ] ...
"""

import torch
import torch.nn.functional as F
from torch import Tensor

from kitchen_prefs.instances import CHOSEN, COLUMNS, DECISION

from ..common.instance_sets import is_dish, is_real, keep
from .rack_poses import RACKS, find_racks


def tokens_of_prompts(prompts: Tensor, kind: str) -> tuple[Tensor, Tensor]:
    """Choose and arrange the rows that become tokens.

    Args:
        prompts: Demonstrations, zero-padded, (G, P, 14).
        kind: "states", "chosen" or "final".

    Returns:
        The tokens' rows, (G, L, 13), and which of them are real, (G, L) bool.
    """
    if kind == "chosen":
        rows, mask = keep(prompts, is_real(prompts) & (prompts[..., CHOSEN] > 0))
        return rows[..., :COLUMNS], mask
    if kind == "final":
        rows, mask = keep(prompts[..., :COLUMNS], in_the_end(prompts))
        return rows.index_fill(-1, torch.tensor([DECISION], device=rows.device), 0), mask
    return _with_act_tokens(*keep(prompts[..., :COLUMNS], is_real(prompts)))


def in_the_end(prompts: Tensor) -> Tensor:
    """Which rows are dishes in a rack at the last decision that saw that rack.

    Args:
        prompts: Demonstrations, zero-padded, (G, P, 14).

    Returns:
        A mask, (G, P) bool. A dish never leaves a rack, so the last decision that saw dishes in a
        rack saw all of them.
    """
    rack, in_rack = find_racks(prompts)
    stands = is_dish(prompts) & in_rack  # (G, P)
    last_seen = torch.zeros_like(stands)
    for one in range(RACKS):
        in_this = stands & (rack == one)
        decision = prompts[..., DECISION].where(in_this, -1)  # (G, P)
        last_seen |= in_this & (decision == decision.amax(dim=1, keepdim=True))
    return last_seen


def _with_act_tokens(rows: Tensor, mask: Tensor) -> tuple[Tensor, Tensor]:
    """Put a row of zeros after each decision's rows, (G, M, 13), of which `mask` are real."""
    begins = (rows[:, 1:, DECISION] != rows[:, :-1, DECISION]) & mask[:, 1:]  # (G, M - 1)
    acts_before = F.pad(begins.cumsum(dim=1), (1, 0))  # (G, M)
    length = rows.shape[1] + int(acts_before.max()) + 1
    target = torch.arange(rows.shape[1], device=rows.device) + acts_before  # (G, M)
    target = target.where(mask, length)  # padding goes to a last row, which is cut off
    tokens = rows.new_zeros(len(rows), length + 1, COLUMNS)
    tokens.scatter_(1, target[..., None].expand(-1, -1, COLUMNS), rows)
    real = mask.sum(dim=1) + acts_before.amax(dim=1) + 1  # (G,)
    return tokens[:, :length], torch.arange(length, device=rows.device) < real[:, None]
