"""Attention between sets of tokens, with or without the geometry of their instances."""

from typing import NamedTuple, Self

import torch
import torch.nn.functional as F
from torch import Tensor, nn


class Tokens(NamedTuple):
    """Sets of tokens.

    Attributes:
        features: The tokens, (B, N, d).
        mask: Which of them are real, (B, N) bool.
        geometry: Extents and position in m of the instances that they stand for, and whether these
            are objects; zeros for ACT tokens and slots, which stand for none, (B, N, 7).
    """

    features: Tensor
    mask: Tensor
    geometry: Tensor

    def with_features(self, features: Tensor) -> Self:
        """The same tokens with other features."""
        return self._replace(features=features)


class Attention(nn.Module):
    """Multi-head attention of tokens to a memory (Vaswani et al., 2017)."""

    def __init__(self, dim: int, heads: int, geometric_scores: "GeometricScores | None") -> None:
        """Make `heads` heads that share `dim` dimensions."""
        super().__init__()
        self.heads = heads
        self.query = nn.Linear(dim, dim)
        self.key_value = nn.Linear(dim, 2 * dim)
        self.output = nn.Linear(dim, dim)
        self.geometric_scores = geometric_scores

    def forward(self, tokens: Tokens, memory: Tokens, memory_of: Tensor | None = None) -> Tensor:
        """Attend.

        Args:
            tokens: What attends, B sets of N tokens.
            memory: What is attended to, G sets of M tokens.
            memory_of: The memory of each of the B sets, (B,) int; absent where G = B. A memory is
                projected once, however many sets attend to it.

        Returns:
            The attended values, (B, N, d).
        """
        queries = self._split(self.query(tokens.features))  # (B, h, N, d/h)
        keys, values = self.key_value(memory.features).chunk(2, dim=-1)  # (G, M, d)
        keys, values = self._split(keys), self._split(values)  # (G, h, M, d/h)
        width = values.shape[-1]
        if self.geometric_scores:
            queries, keys = self.geometric_scores(queries, keys, tokens.geometry, memory.geometry)
            values = F.pad(values, (0, keys.shape[-1] - width))  # the fast kernel wants equal sizes
        mask = memory.mask[:, None, None]  # (G, 1, 1, M)
        if memory_of is not None:
            keys, values, mask = keys[memory_of], values[memory_of], mask[memory_of]
        attended = F.scaled_dot_product_attention(queries, keys, values, attn_mask=mask)
        return self.output(attended[..., :width].transpose(1, 2).flatten(2))  # (B, N, d)

    def _split(self, features: Tensor) -> Tensor:
        return features.unflatten(-1, (self.heads, -1)).transpose(1, 2)  # (B, h, N, d/h)


class GeometricScores(nn.Module):
    """Attention to what is alike, to what is near, and to what is there already.

    To the score of a pair of instances i, j each head adds, with its own learned a, b and c,

        - a |extents_i - extents_j|^2 - b |position_i - position_j|^2 + c is_object_j.

    What depends on i alone drops out of a softmax, so this is a dot product of nine more dimensions
    of queries and keys, e for extents and p for position:

        (2a e_i, -a, 2b p_i, -b, c) . (e_j, |e_j|^2, p_j, |p_j|^2, is_object_j)
    """

    # Of a and b in 1 / m^2, and of c: parameters of order one learn at the pace of the others.
    UNITS = (1000.0, 1000.0, 10.0)

    def __init__(self, start: list[tuple[float, float, float]]) -> None:
        """Start from an a, a b and a c for each head."""
        super().__init__()
        self.weights = nn.Parameter(torch.tensor(start) / torch.tensor(self.UNITS))  # (h, 3)

    def forward(
        self, queries: Tensor, keys: Tensor, geometry: Tensor, memory_geometry: Tensor
    ) -> tuple[Tensor, Tensor]:
        """Add the dimensions.

        Args:
            queries: (B, h, N, d/h).
            keys: (G, h, M, d/h).
            geometry: The geometry of what attends, (B, N, 7).
            memory_geometry: The geometry of what is attended to, (G, M, 7).

        Returns:
            The longer queries and keys, (B, h, N, d/h + 9) and (G, h, M, d/h + 9). What is added to
            the queries makes up for the square root by which attention divides scores.
        """
        e, p, _ = geometry.split((3, 3, 1), dim=-1)
        is_instance = (geometry != 0).any(dim=-1, keepdim=True).to(geometry.dtype)  # (B, N, 1)
        of_i = torch.cat([2 * e, -is_instance, 2 * p, -is_instance, is_instance], dim=-1)
        e, p, is_object = memory_geometry.split((3, 3, 1), dim=-1)
        of_j = torch.cat([e, _square(e), p, _square(p), is_object], dim=-1)  # (G, M, 9)
        scale = (queries.shape[-1] + of_i.shape[-1]) ** 0.5
        repeats = torch.tensor((4, 4, 1), device=queries.device)
        weights = scale * self.weights * self.weights.new_tensor(self.UNITS)  # (h, 3)
        weights = weights.repeat_interleave(repeats, dim=1)  # (h, 9)
        of_i = of_i[:, None] * weights[:, None]  # (B, h, N, 9)
        of_j = of_j[:, None].expand(-1, self.weights.shape[0], -1, -1)  # (G, h, M, 9)
        return torch.cat([queries, of_i], dim=-1), torch.cat([keys, of_j], dim=-1)


def _square(vectors: Tensor) -> Tensor:
    return vectors.square().sum(dim=-1, keepdim=True)
