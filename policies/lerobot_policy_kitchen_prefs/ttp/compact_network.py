"""Where the network departs from the paper: each departure is a switch of `TTPConfig`.

- `pre_norm`: layers normalise their input, not their sum.
- `geometric_attention`: attention adds how near two instances are in size and position.
- `pointer="outputs"`: the pointer compares the decoder's outputs, not the embeddings e_i.
- `situation_time=False`: the situation's rows do not tell the decision's index.
- `clashes`: learned shapes decide which places are blocked (`common.collision_model`).
- `failures`: the network sees which choices have just failed (`common.failed_choices`).

Denoising (`recognise`) is done before the network, in `modeling_ttp`; prompts of chosen rows are
made by `prompt_tokens`; more preferences in training by `relabelling` and `prompt_pairing`.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import torch
import torch.nn.functional as F
from torch import Tensor, nn

from kitchen_prefs.instances import DECISION, EXTENTS, IS_OBJECT, POSITION

from ..common.collision_model import CollisionModel, attended_rows
from ..common.failed_choices import FailureEmbedding
from ..common.instance_sets import gather_rows, selected_indices
from ..common.score_correction import correct_scores
from .configuration_ttp import TTPConfig
from .encoder_ablations import hide
from .network import Situations, TTPNetwork, point
from .transformer import Attention, DecoderLayer, EncoderLayer, Residual, Tokens

# Pre-norm ----------------------------------------------------------------------------------------


class PreNormResidual(Residual):
    """A sub-layer of the normalised input, added to the input (Xiong et al., 2020)."""

    def forward(self, tokens: Tokens, sublayer: Callable[[Tokens], Tensor]) -> Tokens:
        """Apply a sub-layer to sets of tokens."""
        normalised = tokens.with_features(self.norm(tokens.features))
        return tokens.with_features(tokens.features + sublayer(normalised))


# Geometric attention -----------------------------------------------------------------------------

GEOMETRY = [*range(EXTENTS.start, POSITION.stop), IS_OBJECT]  # the columns that attention sees


@dataclass(frozen=True)
class GeometricTokens(Tokens):
    """Tokens with the geometry of their instances.

    Attributes:
        geometry: Extents and position in m, and whether the instances are objects; zeros for ACT
            tokens and slots, which stand for no instance, (B, N, 7).
    """

    geometry: Tensor


class GeometricAttention(Attention):
    """Attention that prefers instances of similar size, nearby instances, and objects.

    To the score of a pair of instances i, j each head adds, with its own learned a, b and c,

        - a |extents_i - extents_j|^2 - b |position_i - position_j|^2 + c is_object_j.

    Terms of i alone drop out of a softmax, so this is a dot product of nine more dimensions of
    queries and keys, e for extents and p for position:

        (2a e_i, -a, 2b p_i, -b, c) . (e_j, |e_j|^2, p_j, |p_j|^2, is_object_j)
    """

    def __init__(self, dim: int, heads: int, initial: list[tuple[float, float, float]]) -> None:
        """Make the attention.

        Args:
            dim: The dimensions that the heads share.
            heads: The number h of heads.
            initial: The initial a, b (1 / m^2) and c of the first heads; the others have zeros.
        """
        super().__init__(dim, heads)
        initial = (initial + [(0.0, 0.0, 0.0)] * heads)[:heads]
        self.geometric_scores = GeometricScores(initial)

    def project(self, tokens: Tokens, memory: Tokens) -> tuple[Tensor, Tensor, Tensor]:
        """The queries, (B, h, N, d/h + 9), the keys and the values, (G, h, M, d/h + 9) each."""
        assert isinstance(tokens, GeometricTokens)
        assert isinstance(memory, GeometricTokens)
        queries, keys, values = super().project(tokens, memory)
        queries, keys = self.geometric_scores(queries, keys, tokens.geometry, memory.geometry)
        added = keys.shape[-1] - values.shape[-1]
        return queries, keys, F.pad(values, (0, added))  # the fast kernel wants equal sizes


class GeometricScores(nn.Module):
    """The nine dimensions that `GeometricAttention` adds to queries and keys."""

    # Of a and b in 1 / m^2, and of c: parameters of order one learn at the pace of the others.
    UNITS = (1000.0, 1000.0, 10.0)

    def __init__(self, initial: list[tuple[float, float, float]]) -> None:
        """Begin with an a, a b and a c for each head."""
        super().__init__()
        self.weights = nn.Parameter(torch.tensor(initial) / torch.tensor(self.UNITS))  # (h, 3)

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


# The initial a, b and c of heads. Two extents that differ by 5 cm, as those of most categories do,
# cost a score of 4; two positions 20 cm apart cost 2.4, or 12 where a head looks for the nearest
# objects.
SIMILAR = (1500.0, 0.0, 0.0)
NEAR = (0.0, 60.0, 0.0)
NEAREST_OBJECTS = (0.0, 300.0, 10.0)


# The output pointer ------------------------------------------------------------------------------


class OutputPointer(nn.Module):
    """Points at learned projections of the decoder's outputs, which depend on the other rows."""

    def __init__(self, dim: int) -> None:
        """Make the projections of `dim` dimensions."""
        super().__init__()
        self.query = nn.Linear(dim, dim)
        self.key = nn.Linear(dim, dim)

    def forward(self, act: Tensor, outputs: Tensor) -> Tensor:
        """Score the decoder's outputs at rows, (B, N, d), by that at ACT, (B, d): (B, N)."""
        return point(self.query(act), self.key(outputs))


# The network -------------------------------------------------------------------------------------


class CompactNetwork(TTPNetwork):
    """The paper's network with any of the departures above, here with all of them.

        scores (B, N)
          ▲
        correction by collisions and failed choices
          ▲
        output pointer
          ▲
        f_td with geometric attention and pre-norm ◄─── gamma
          ▲
        embedding of failed choices added
          ▲
        f_e of the situation; with a collision model, place decisions attend to places alone

    `clashes` (the collision model) and `failures` are the names of weights in checkpoints.
    """

    def __init__(self, config: TTPConfig) -> None:
        """Make the network of a configuration."""
        super().__init__(config, *layer_factories(config))
        final_norm = nn.LayerNorm if config.pre_norm else nn.Identity
        self.encoder_norm = final_norm(config.dim)
        self.decoder_norm = final_norm(config.dim)
        self.pointer = OutputPointer(config.dim) if config.pointer == "outputs" else None
        self.failures = FailureEmbedding(config.dim) if config.failures else None
        self.clashes = CollisionModel() if config.clashes else None
        time = [] if config.situation_time else [DECISION]
        self.hidden_of_situations = [*self.hidden, *time]

    def decide(self, situations: Situations, preference: Tokens, prompt_of: Tensor) -> Tensor:
        """Score the rows of situations; arguments and result are those of `TTPNetwork.decide`."""
        n = situations.sets.shape[1]
        rows, mask = situations.with_act_token()  # (B, N + K + 1, 13), (B, N + K + 1)
        rows = hide(rows, self.hidden_of_situations)
        if self.clashes:
            mask = F.pad(attended_rows(rows[:, :-1]), (0, 1), value=True)
        inputs = tokens = self.f_e(rows, mask)  # (B, N + K + 1, d)
        if self.failures:
            failed = F.pad(situations.failed, (0, rows.shape[1] - n))  # (B, N + K + 1)
            tokens = tokens.with_features(self.failures.embed(tokens.features, failed))
        outputs = self.f_td(tokens, preference, prompt_of).features  # (B, N + K + 1, d)
        act, outputs = outputs[:, -1], outputs[:, :n]  # (B, d), (B, N, d)
        scores = self.pointer(act, outputs) if self.pointer else point(act, inputs.features[:, :n])
        return correct_scores(
            scores,
            situations.sets,
            self.clashes(rows[:, :n]) if self.clashes else None,
            self.failures.penalties(outputs, situations.failed) if self.failures else None,
        )

    def f_e(self, rows: Tensor, mask: Tensor) -> GeometricTokens:
        """Embed the instances, and keep their geometry for attention."""
        return GeometricTokens(self.instances(rows), mask, rows[..., GEOMETRY])

    def f_te(self, tokens: Tokens) -> Tokens:
        """Transform a prompt's tokens, and normalise them in the end where layers are pre-norm."""
        tokens = super().f_te(tokens)
        return tokens.with_features(self.encoder_norm(tokens.features))

    def f_slot(self, tokens: Tokens) -> Tokens:
        """Reduce a prompt's tokens to H slots, which have no geometry."""
        slots = super().f_slot(tokens)
        if not self.slots:
            return slots
        no_geometry = slots.features.new_zeros(*slots.mask.shape, len(GEOMETRY))  # (G, H, 7)
        return GeometricTokens(slots.features, slots.mask, no_geometry)

    def f_td(self, tokens: Tokens, preference: Tokens, prompt_of: Tensor) -> Tokens:
        """Transform the tokens that are attended to; the outputs at the others are zeros."""
        assert isinstance(tokens, GeometricTokens)
        index, mask = selected_indices(tokens.mask)  # (B, M) each
        features, geometry = (gather_rows(x, index) for x in (tokens.features, tokens.geometry))
        attended = super().f_td(GeometricTokens(features, mask, geometry), preference, prompt_of)
        outputs = self.decoder_norm(attended.features) * mask[..., None]  # (B, M, d)
        zeros = outputs.new_zeros(tokens.features.shape)  # (B, N, d)
        return tokens.with_features(zeros.scatter(1, index[..., None].expand_as(outputs), outputs))


def layer_factories(config: TTPConfig) -> tuple[partial[EncoderLayer], partial[DecoderLayer]]:
    """The factories of the layers of f_te and of f_td."""
    residual = PreNormResidual if config.pre_norm else Residual
    if not config.geometric_attention:
        return partial(EncoderLayer, residual=residual), partial(DecoderLayer, residual=residual)
    self_attention = partial(GeometricAttention, initial=[SIMILAR, NEAR, NEAREST_OBJECTS])
    half = (config.n_heads + 1) // 2  # these heads attend to similar instances in the prompt
    cross_attention = partial(GeometricAttention, initial=[SIMILAR] * half)
    return (
        partial(EncoderLayer, self_attention=self_attention, residual=residual),
        partial(
            DecoderLayer,
            self_attention=self_attention,
            cross_attention=cross_attention,
            residual=residual,
        ),
    )
