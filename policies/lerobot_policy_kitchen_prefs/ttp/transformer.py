"""The transformer of the paper: post-norm layers over sets of tokens (Vaswani et al., 2017)."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Self

import torch.nn.functional as F
from torch import Tensor, nn

from .configuration_ttp import TTPConfig


@dataclass(frozen=True)
class Tokens:
    """Sets of tokens.

    Attributes:
        features: The tokens, (B, N, d).
        mask: Which of them are real and attended to, (B, N) bool.
    """

    features: Tensor
    mask: Tensor

    def with_features(self, features: Tensor) -> Self:
        """The same tokens with other features."""
        return replace(self, features=features)

    def joined(self, count: int) -> Self:
        """The tokens of every `count` sets as those of one."""
        parts = (part.unflatten(0, (-1, count)).flatten(1, 2) for part in vars(self).values())
        return type(self)(*parts)


class Attention(nn.Module):
    """Multi-head attention of tokens to a memory."""

    def __init__(self, dim: int, heads: int) -> None:
        """Make `heads` heads that share `dim` dimensions."""
        super().__init__()
        self.dim, self.heads = dim, heads
        self.query = nn.Linear(dim, dim)
        self.key_value = nn.Linear(dim, 2 * dim)
        self.output = nn.Linear(dim, dim)

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
        queries, keys, values = self.project(tokens, memory)
        mask = memory.mask[:, None, None]  # (G, 1, 1, M)
        if memory_of is not None:
            keys, values, mask = keys[memory_of], values[memory_of], mask[memory_of]
        attended = F.scaled_dot_product_attention(queries, keys, values, attn_mask=mask)
        attended = attended[..., : self.dim // self.heads]  # (B, h, N, d/h)
        return self.output(attended.transpose(1, 2).flatten(2))  # (B, N, d)

    def project(self, tokens: Tokens, memory: Tokens) -> tuple[Tensor, Tensor, Tensor]:
        """The queries, (B, h, N, d/h), the keys and the values, (G, h, M, d/h) each."""
        queries = self._split(self.query(tokens.features))
        keys, values = map(self._split, self.key_value(memory.features).chunk(2, dim=-1))
        return queries, keys, values

    def _split(self, features: Tensor) -> Tensor:
        return features.unflatten(-1, (self.heads, -1)).transpose(1, 2)  # (B, h, N, d/h)


class Residual(nn.Module):
    """A sub-layer that is added to its input, then normalised."""

    def __init__(self, dim: int) -> None:
        """Make the normalisation of `dim` dimensions."""
        super().__init__()
        self.norm = nn.LayerNorm(dim)

    def forward(self, tokens: Tokens, sublayer: Callable[[Tokens], Tensor]) -> Tokens:
        """Apply a sub-layer to sets of tokens."""
        return tokens.with_features(self.norm(tokens.features + sublayer(tokens)))


class EncoderLayer(nn.Module):
    """A layer of f_te: self-attention and a feed-forward network."""

    def __init__(
        self,
        config: TTPConfig,
        self_attention: Callable[[int, int], Attention] = Attention,
        residual: Callable[[int], Residual] = Residual,
    ) -> None:
        """Make a layer of the configured sizes.

        Args:
            config: The configuration.
            self_attention: Makes the attention from its dimensions and its heads.
            residual: Makes a residual connection from its dimensions.
        """
        super().__init__()
        self.attention = self_attention(config.dim, config.n_heads)
        self.feedforward = feedforward(config)
        self.residuals = nn.ModuleList(residual(config.dim) for _ in range(2))

    def forward(self, tokens: Tokens) -> Tokens:
        """Transform sets of tokens."""
        attend, feed = self.residuals
        tokens = attend(tokens, lambda x: self.attention(x, x))
        return feed(tokens, lambda x: self.feedforward(x.features))


class DecoderLayer(nn.Module):
    """A layer of f_td: self-attention, cross-attention to gamma, and a feed-forward network."""

    def __init__(
        self,
        config: TTPConfig,
        self_attention: Callable[[int, int], Attention] = Attention,
        cross_attention: Callable[[int, int], Attention] = Attention,
        residual: Callable[[int], Residual] = Residual,
    ) -> None:
        """Make a layer of the configured sizes; the arguments are those of `EncoderLayer`."""
        super().__init__()
        self.attention = self_attention(config.dim, config.n_heads)
        self.cross_attention = cross_attention(config.dim, config.n_heads)
        self.feedforward = feedforward(config)
        self.residuals = nn.ModuleList(residual(config.dim) for _ in range(3))

    def forward(self, tokens: Tokens, preference: Tokens, prompt_of: Tensor) -> Tokens:
        """Transform sets of tokens.

        Args:
            tokens: The tokens of B situations.
            preference: The preference embeddings gamma of G prompts.
            prompt_of: The prompt of each situation, (B,) int.

        Returns:
            The tokens, transformed.
        """
        attend, cross, feed = self.residuals
        tokens = attend(tokens, lambda x: self.attention(x, x))
        tokens = cross(tokens, lambda x: self.cross_attention(x, preference, prompt_of))
        return feed(tokens, lambda x: self.feedforward(x.features))


def feedforward(config: TTPConfig) -> nn.Sequential:
    """Make the feed-forward network of a layer."""
    return nn.Sequential(
        nn.Linear(config.dim, config.dim_feedforward),
        nn.ReLU(),
        nn.Linear(config.dim_feedforward, config.dim),
    )
