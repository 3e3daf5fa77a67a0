"""From a whole demonstration to the rows of a prompt's tokens.

The demonstration, as `kitchen_prefs.instances` draws it, has a row for each instance of each
decision. The paper's tokens are all of them, with an ACT token (A) after each decision's
set:

    [ set of decision 0 ] A [ set of decision 1 ] A ... [ set of decision T-1 ] A

The compact tokens are the chosen rows alone, which the paper leaves out:

    [ chosen row 0 ] [ chosen row 1 ] ... [ chosen row T-1 ]
"""

import torch
import torch.nn.functional as F
from torch import Tensor

from kitchen_prefs.instances import CHOSEN, COLUMNS, DECISION

from ..instances.sets import is_real, keep


def tokens_of_prompts(prompts: Tensor, kind: str) -> tuple[Tensor, Tensor]:
    """Choose and arrange the rows that become tokens.

    Args:
        prompts: Demonstrations, zero-padded, (G, P, 14).
        kind: "states" or "chosen".

    Returns:
        The tokens' rows, (G, L, 13), and which of them are real, (G, L) bool.
    """
    if kind == "chosen":
        rows, mask = keep(prompts, is_real(prompts) & (prompts[..., CHOSEN] > 0))
        return rows[..., :COLUMNS], mask
    return _with_act_tokens(*keep(prompts[..., :COLUMNS], is_real(prompts)))


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
