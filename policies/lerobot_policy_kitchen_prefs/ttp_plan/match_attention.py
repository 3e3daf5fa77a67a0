"""Attention by what two dishes have in common: the likeness of pairs, and heads that begin with it.

A rule of a user speaks of an attribute: the wooden, the greasy, the blue, the mugs. So each head
begins with one attribute, or two, that must be the same, and learns on from there.
"""

import torch
import torch.nn.functional as F
from torch import Tensor, nn

from .dish_tokens import (
    CATEGORY_PART,
    COLOUR_PART,
    MATERIAL_PART,
    SIZE_PART,
    SOIL_PART,
)

KINDS, KIND_SIZE = 4, 6  # learned divisions of dishes by their extents, as into families or sizes
COLOUR_SHARPNESS = 50.0  # 1 / RGB^2; the nearest two colours are .4 apart

# What a pair of dishes may have in common, and what a pair that was shown may, see `Likeness` and
# `plan_reader`.
COMMON = ("category", "material", "colour", "soil", *(f"kind {i}" for i in range(KINDS)))
OF_SHOWN = (
    *("zone", "rack", "later", "preferred", "preferred though farther"),
    *("farther", "moment", "itself"),
)
HEADS = (
    *((name,) for name in COMMON),
    ("category", "colour"),
    ("category", "material"),
    (),  # attends to all dishes
)
HEAD_DIM = 16
SAME = 6.0  # a head's initial score for what is in common: e^6 outweighs the other dishes


class Likeness(nn.Module):
    """How far two dishes have each of COMMON in common, from 0 to 1."""

    def __init__(self) -> None:
        """Make the learned kinds."""
        super().__init__()
        self.kinds = nn.Sequential(nn.Linear(3, 64), nn.GELU(), nn.Linear(64, KINDS * KIND_SIZE))

    def forward(self, one: Tensor, other: Tensor) -> Tensor:
        """Compare dishes (B, m, 18) with others (B, n, 18): (B, m, n, 8)."""
        alike = [one[..., part] @ other[..., part].mT for part in (CATEGORY_PART, MATERIAL_PART)]
        apart = torch.cdist(one[..., COLOUR_PART], other[..., COLOUR_PART])  # (B, m, n)
        soil = one[..., SOIL_PART] - other[..., SOIL_PART].mT  # (B, m, n)
        alike += [torch.exp(-COLOUR_SHARPNESS * apart.square()), 1 - soil.abs()]
        of_a_kind = self._memberships(one) @ self._memberships(other).mT  # (B, 4, m, n)
        return torch.cat([torch.stack(alike, -1), of_a_kind.permute(0, 2, 3, 1)], dim=-1)

    def _memberships(self, attributes: Tensor) -> Tensor:
        """The dishes' memberships in learned kinds, (B, n, 18) -> (B, 4, n, 6)."""
        kinds = self.kinds(3 * attributes[..., SIZE_PART]).unflatten(-1, (KINDS, KIND_SIZE))
        return kinds.softmax(dim=-1).transpose(1, 2)


def by_head(common: Tensor) -> Tensor:
    """How far pairs have all that a head wants in common, (B, m, n, 8) -> (B, h, m, n)."""
    whole = torch.ones_like(common[..., 0])
    named = dict(zip(COMMON, common.unbind(-1), strict=True))
    heads = []
    for head in HEADS:
        alike = whole
        for name in head:
            alike = alike * named[name]
        heads.append(alike)
    return torch.stack(heads, dim=1)


class MatchLayer(nn.Module):
    """Match attention and a feed-forward network, each of the normalised input."""

    def __init__(self, dim: int, hidden: int, dropout: float) -> None:
        """Make a layer."""
        super().__init__()
        self.norms = nn.ModuleList(nn.LayerNorm(dim) for _ in range(2))
        self.attention = MatchAttention(dim)
        self.feedforward = nn.Sequential(nn.Linear(dim, hidden), nn.GELU(), nn.Linear(hidden, dim))
        self.dropout = nn.Dropout(dropout)

    def forward(self, features: Tensor, memory: Tensor, common: Tensor, mask: Tensor) -> Tensor:
        """Transform features by a memory.

        Args:
            features: (B, m, d).
            memory: (B, n, d).
            common: What the pairs have in common, COMMON and OF_SHOWN, (B, m, n, 16).
            mask: Which of the memory are real, (B, n) bool.

        Returns:
            (B, m, d).
        """
        attend, feed = self.norms
        attended = self.attention(attend(features), attend(memory), common, mask)
        features = features + self.dropout(attended)
        return features + self.dropout(self.feedforward(feed(features)))


class MatchAttention(nn.Module):
    """Attention whose heads add learned weights of what a pair has in common to its score."""

    def __init__(self, dim: int) -> None:
        """Make a head for each of HEADS."""
        super().__init__()
        inner = len(HEADS) * HEAD_DIM
        self.query = nn.Linear(dim, inner)
        self.key_value = nn.Linear(dim, 2 * inner)
        self.output = nn.Linear(inner, dim)
        names = (*COMMON, *OF_SHOWN)
        weights = [[SAME * (name in head) for name in names] for head in HEADS]
        self.weights = nn.Parameter(torch.tensor(weights))  # (h, 16)

    def forward(self, features: Tensor, memory: Tensor, common: Tensor, mask: Tensor) -> Tensor:
        """Attend; the arguments are those of `MatchLayer.forward`, and the result (B, m, d)."""
        keys, values = map(_heads, self.key_value(memory).chunk(2, dim=-1))
        bias = torch.einsum("bmnk,hk->bhmn", common, self.weights)
        bias = bias.masked_fill(~mask[:, None, None], -torch.inf)
        attended = F.scaled_dot_product_attention(
            _heads(self.query(features)), keys, values, attn_mask=bias
        )  # (B, h, m, 16)
        return self.output(attended.transpose(1, 2).flatten(2))


def _heads(features: Tensor) -> Tensor:
    return features.unflatten(-1, (-1, HEAD_DIM)).transpose(1, 2)  # (B, h, n, 16)
