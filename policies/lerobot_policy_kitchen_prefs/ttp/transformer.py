"""The layers of prompt encoder and situation decoder (Vaswani et al., 2017)."""

from collections.abc import Callable

from torch import Tensor, nn

from .attention import Attention, GeometricScores, Tokens
from .configuration_ttp import TTPConfig

# Where geometric attention starts, head by head. Two extents that differ by 5 cm, as those of most
# categories do, cost a score of 4; two positions 20 cm apart cost 2.4, or 12 where a head looks for
# the nearest objects.
ALIKE = (1500.0, 0.0, 0.0)
NEAR = (0.0, 60.0, 0.0)
NEAREST_OBJECTS = (0.0, 300.0, 10.0)
PLAIN = (0.0, 0.0, 0.0)


class EncoderLayer(nn.Module):
    """Self-attention and a feed-forward network."""

    def __init__(self, config: TTPConfig) -> None:
        """Make a layer of the configured sizes."""
        super().__init__()
        self.attention = self_attention(config)
        self.feedforward = feedforward(config)
        self.residuals = nn.ModuleList(Residual(config) for _ in range(2))

    def forward(self, tokens: Tokens) -> Tokens:
        """Transform sets of tokens."""
        attend, feed = self.residuals
        tokens = attend(tokens, lambda x: self.attention(x, x))
        return feed(tokens, lambda x: self.feedforward(x.features))


class DecoderLayer(nn.Module):
    """Self-attention, cross-attention to the preference embedding, and a feed-forward network."""

    def __init__(self, config: TTPConfig) -> None:
        """Make a layer of the configured sizes."""
        super().__init__()
        self.attention = self_attention(config)
        self.cross_attention = cross_attention(config)
        self.feedforward = feedforward(config)
        self.residuals = nn.ModuleList(Residual(config) for _ in range(3))

    def forward(self, tokens: Tokens, preference: Tokens, prompt_of: Tensor) -> Tokens:
        """Transform sets of tokens.

        Args:
            tokens: The tokens of B situations.
            preference: The encoded prompts, G of them.
            prompt_of: The prompt of each situation, (B,) int.

        Returns:
            The tokens, transformed.
        """
        attend, cross, feed = self.residuals
        tokens = attend(tokens, lambda x: self.attention(x, x))
        tokens = cross(tokens, lambda x: self.cross_attention(x, preference, prompt_of))
        return feed(tokens, lambda x: self.feedforward(x.features))


class Residual(nn.Module):
    """A sub-layer added to its input, with layer normalisation before it or after the sum."""

    def __init__(self, config: TTPConfig) -> None:
        """Make the normalisation."""
        super().__init__()
        self.pre_norm = config.pre_norm
        self.norm = nn.LayerNorm(config.dim)

    def forward(self, tokens: Tokens, sublayer: Callable[[Tokens], Tensor]) -> Tokens:
        """Apply a sub-layer to sets of tokens."""
        if self.pre_norm:
            normalised = tokens.with_features(self.norm(tokens.features))
            return tokens.with_features(tokens.features + sublayer(normalised))
        return tokens.with_features(self.norm(tokens.features + sublayer(tokens)))


def feedforward(config: TTPConfig) -> nn.Sequential:
    """Make the feed-forward network of a layer."""
    return nn.Sequential(
        nn.Linear(config.dim, config.dim_feedforward),
        nn.ReLU(),
        nn.Linear(config.dim_feedforward, config.dim),
    )


def self_attention(config: TTPConfig) -> Attention:
    """Make the attention of a set to itself."""
    return _attention(config, [ALIKE, NEAR, NEAREST_OBJECTS])


def cross_attention(config: TTPConfig) -> Attention:
    """Make the attention of a situation to a prompt: half of the heads look for what is alike."""
    return _attention(config, [ALIKE] * ((config.n_heads + 1) // 2))


def _attention(config: TTPConfig, start: list[tuple[float, float, float]]) -> Attention:
    if not config.geometric_attention:
        return Attention(config.dim, config.n_heads, None)
    start = (start + [PLAIN] * config.n_heads)[: config.n_heads]
    return Attention(config.dim, config.n_heads, GeometricScores(start))
