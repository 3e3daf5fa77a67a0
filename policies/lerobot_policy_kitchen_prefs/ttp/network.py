"""The Transformer Task Planner, in the paper's order and by its names (section 2).

Tensors have B situations of N rows, G prompts of P tokens, H slots and d dimensions. What departs
from the paper is in `compact_network`; the encoders that its appendix compares are in
`encoder_ablations`.
"""

from collections.abc import Callable
from typing import NamedTuple, Self

import torch
import torch.nn.functional as F
from torch import Tensor, nn

from kitchen_prefs.instances import (
    COLUMNS,
    DECISION,
    DESCRIBED_COLUMNS,
    EXTENTS,
    IS_OBJECT,
    IS_PLACE,
    POSITION,
    QUATERNION,
    is_real,
)

from ..common.fourier_features import (
    EXTENTS_RANGE,
    FREQUENCIES,
    POSITION_RANGE,
    QUATERNION_RANGE,
    FourierFeatures,
)
from ..common.instance_sets import longest
from .configuration_ttp import DIM_DESCRIPTION, MAX_DECISIONS, TTPConfig
from .encoder_ablations import (
    FourierTimeEncoder,
    LabelCategoryEncoder,
    LinearCategoryEncoder,
    LinearPoseEncoder,
    columns_of,
    hide,
)
from .transformer import DecoderLayer, EncoderLayer, Tokens

# The instance encoder f_e ------------------------------------------------------------------------


class TimeEncoder(nn.Module):
    """Phi_t: a learned embedding of each decision's index."""

    def __init__(self, dim: int) -> None:
        """Make a table of `dim` dimensions."""
        super().__init__()
        self.table = nn.Embedding(MAX_DECISIONS, dim)

    def forward(self, decision: Tensor) -> Tensor:
        """Embed indices (...) as (..., dim); those beyond the table take its last entry."""
        return self.table(decision.long().clamp(0, MAX_DECISIONS - 1))


class CategoryEncoder(nn.Module):
    """Phi_c: an MLP on Fourier features of the extents, the best of the paper's ablation."""

    def __init__(self, dim: int) -> None:
        """Make an encoder of `dim` dimensions."""
        super().__init__()
        self.layers = nn.Sequential(
            FourierFeatures(EXTENTS_RANGE),
            nn.Linear(3 * 2 * FREQUENCIES, dim),
            nn.GELU(),
            nn.Linear(dim, dim),
        )

    def forward(self, extents: Tensor) -> Tensor:
        """Embed extents (..., 3) as (..., dim)."""
        return self.layers(extents)


class PoseEncoder(nn.Module):
    """Phi_p: Fourier features of the position and the quaternion, and one linear layer."""

    def __init__(self, dim: int) -> None:
        """Make an encoder of `dim` dimensions."""
        super().__init__()
        self.position = FourierFeatures(POSITION_RANGE)
        self.quaternion = FourierFeatures(QUATERNION_RANGE)
        self.linear = nn.Linear(7 * 2 * FREQUENCIES, dim)

    def forward(self, position: Tensor, quaternion: Tensor) -> Tensor:
        """Embed positions (..., 3) and quaternions (..., 4) as (..., dim)."""
        features = [self.position(position), self.quaternion(quaternion)]
        return self.linear(torch.cat(features, dim=-1))


class MarkerEncoder(nn.Module):
    """Phi_r: a learned embedding of objects, one of places, one of ACT tokens."""

    def __init__(self, dim: int) -> None:
        """Make a table of `dim` dimensions."""
        super().__init__()
        self.table = nn.Embedding(3, dim)

    def forward(self, is_object: Tensor, is_place: Tensor) -> Tensor:
        """Embed two markers (...) as (..., dim)."""
        return self.table((is_object + 2 * is_place).long())


class DescriptionEncoder(nn.Module):
    """An MLP on colour, material and soil, which the dishes of the second tier have."""

    def __init__(self, dim: int) -> None:
        """Make an encoder of `dim` dimensions."""
        super().__init__()
        described = DESCRIBED_COLUMNS - COLUMNS
        self.layers = nn.Sequential(nn.Linear(described, dim), nn.GELU(), nn.Linear(dim, dim))

    def forward(self, description: Tensor) -> Tensor:
        """Embed descriptions (..., 8) as (..., dim)."""
        return self.layers(description)


TIME_ENCODERS = {"table": TimeEncoder, "fourier": FourierTimeEncoder}
CATEGORY_ENCODERS = {
    "fourier": CategoryEncoder,
    "linear": LinearCategoryEncoder,
    "label": LabelCategoryEncoder,
}
POSE_ENCODERS = {"fourier": PoseEncoder, "linear": LinearPoseEncoder}


class InstanceEncoder(nn.Module):
    """f_e: embeds each instance x_i, object or place, of prompt and situation alike.

        f_e(x_i) = Phi_t(time) || Phi_c(category) || Phi_p(pose) || Phi_r(object or place) = e_i

    In the second tier, whose dishes are described, e_i has a fifth part for that.

    A row of zeros is an ACT token (paper, "a zero vector for all attributes").
    """

    def __init__(self, config: TTPConfig) -> None:
        """Make the four attribute encoders of the configured kinds and sizes."""
        super().__init__()
        self.time = TIME_ENCODERS[config.time_encoding](config.dim_time)
        self.extents = CATEGORY_ENCODERS[config.extents_encoding](config.dim_extents)
        self.pose = POSE_ENCODERS[config.pose_encoding](config.dim_pose)
        self.marker = MarkerEncoder(config.dim_marker)
        self.description = DescriptionEncoder(DIM_DESCRIPTION) if config.described else None

    def forward(self, rows: Tensor) -> Tensor:
        """Embed rows (..., 13), or (..., 21) where dishes are described, as (..., d)."""
        parts = [
            self.time(rows[..., DECISION]),
            self.extents(rows[..., EXTENTS]),
            self.pose(rows[..., POSITION], rows[..., QUATERNION]),
            self.marker(rows[..., IS_OBJECT], rows[..., IS_PLACE]),
        ]
        if self.description:
            parts.append(self.description(rows[..., COLUMNS:]))
        return torch.cat(parts, dim=-1)


# Slot attention f_slot ---------------------------------------------------------------------------

EPSILON = 1e-8  # avoids a division by zero for a slot without tokens (original implementation)


class SlotAttention(nn.Module):
    """f_slot: the bottleneck; H slots compete for a prompt's tokens (Locatello et al., 2020).

    The original draws the initial slots at random. Here they are learned, so that a prompt always
    has the same preference embedding.
    """

    def __init__(self, config: TTPConfig) -> None:
        """Make the configured number of slots."""
        super().__init__()
        dim = config.dim
        self.iterations = config.slot_iterations
        self.start = nn.Parameter(torch.randn(config.num_slots, dim) * dim**-0.5)  # (H, d)
        self.query = nn.Linear(dim, dim, bias=False)
        self.key = nn.Linear(dim, dim, bias=False)
        self.value = nn.Linear(dim, dim, bias=False)
        self.update = nn.GRUCell(dim, dim)
        self.feedforward = nn.Sequential(
            nn.LayerNorm(dim), nn.Linear(dim, 2 * dim), nn.ReLU(), nn.Linear(2 * dim, dim)
        )
        self.norm_tokens = nn.LayerNorm(dim)
        self.norm_slots = nn.LayerNorm(dim)

    def forward(self, prompts: Tokens) -> Tokens:
        """Reduce G encoded prompts of P tokens to H slots each."""
        tokens = self.norm_tokens(prompts.features)  # (G, P, d)
        keys, values = self.key(tokens), self.value(tokens)  # (G, P, d)
        slots = self.start.expand(len(tokens), -1, -1)  # (G, H, d)
        for _ in range(self.iterations):
            queries = self.query(self.norm_slots(slots))  # (G, H, d)
            scores = queries @ keys.transpose(1, 2) * keys.shape[-1] ** -0.5  # (G, H, P)
            weights = scores.softmax(dim=1) * prompts.mask[:, None]  # (G, H, P), over the slots
            total = weights.sum(dim=-1, keepdim=True) + EPSILON  # (G, H, 1)
            updates = weights / total @ values  # (G, H, d)
            slots = self.update(updates.flatten(0, 1), slots.flatten(0, 1)).view_as(slots)
            slots = slots + self.feedforward(slots)  # (G, H, d)
        return Tokens(slots, torch.ones_like(slots[..., 0], dtype=torch.bool))


# The pointer -------------------------------------------------------------------------------------


def point(act: Tensor, instances: Tensor) -> Tensor:
    """Score instances by their dot products with the output at the ACT token.

    Args:
        act: The output x_ACT, (B, d).
        instances: The instances' embeddings e_i, (B, N, d).

    Returns:
        The scores, (B, N), divided by the square root of d as in attention. The paper does not say
        so; undivided scores of an untrained network are far from equal.
    """
    return torch.einsum("bd,bnd->bn", act, instances) * act.shape[-1] ** -0.5


# Prompt encoder and situation decoder ------------------------------------------------------------


class Situations(NamedTuple):
    """The inputs of B decisions.

    Attributes:
        sets: The instance sets, zero-padded, (B, N, 13).
        failed: Which rows have just failed, (B, N) bool; `CompactNetwork` reads it.
        history: The objects of earlier decisions, zero-padded, (B, K, 13); K is 0 without a context
            history (paper, appendix "Markov assumption").
    """

    sets: Tensor
    failed: Tensor
    history: Tensor

    def select(self, which: Tensor) -> Self:
        """Some of the situations, by index or mask."""
        return type(self)(self.sets[which], self.failed[which], self.history[which])

    def trimmed(self) -> Self:
        """The same situations without the padding that the longest set does not need."""
        rows = longest(self.sets)
        return self._replace(sets=self.sets[:, :rows], failed=self.failed[:, :rows])

    def with_act_token(self) -> tuple[Tensor, Tensor]:
        """The rows of sets and history, and an ACT token's row of zeros as the last.

        Returns:
            The rows, (B, N + K + 1, 13), and which of them are real, (B, N + K + 1) bool.
        """
        rows = torch.cat([self.sets, self.history], dim=1)  # (B, N + K, 13)
        return F.pad(rows, (0, 0, 0, 1)), F.pad(is_real(rows), (0, 1), value=True)


class TTPNetwork(nn.Module):
    """Prompt encoder psi and situation decoder pi, trained together (paper, section 2.1).

                                                    scores (B, N)
                                                         ▲
                                                   pointer x_ACT · e_i ◄────┐
                                                         ▲                  │
        ┌─ prompt encoder psi ─┐             ┌─ situation decoder pi ─┐     │
        │                      │    gamma    │                        │     │
        │  f_slot ─────────────┼────────────►│  f_td: self-attention, │     │
        │    ▲      (G, H, d)  │             │   cross-attention      │     │
        │  f_te                │             │           ▲            │     │
        │    ▲      (G, P, d)  │             │           ├────────────┼─────┘
        │  f_e                 │             │          f_e           │   e_i (B, N, d)
        └────▲─────────────────┘             └───────────▲────────────┘
        [S_0, ACT, S_1, ACT, ...]                    [S, ACT]
              (G, P, 13)                          (B, N + 1, 13)

    One instance encoder f_e serves both. The modules have the names of the weights in checkpoints:
    `instances` is f_e, `encoder` f_te, `slots` f_slot and `decoder` f_td.
    """

    def __init__(
        self,
        config: TTPConfig,
        encoder_layer: Callable[[TTPConfig], EncoderLayer] = EncoderLayer,
        decoder_layer: Callable[[TTPConfig], DecoderLayer] = DecoderLayer,
    ) -> None:
        """Make the network of a configuration.

        Args:
            config: The configuration.
            encoder_layer: Makes a layer of f_te.
            decoder_layer: Makes a layer of f_td.
        """
        super().__init__()
        self.hidden = columns_of(config.hidden)
        self.instances = InstanceEncoder(config)
        self.encoder = nn.ModuleList(encoder_layer(config) for _ in range(config.n_encoder_layers))
        self.slots = SlotAttention(config) if config.use_slots else None
        self.decoder = nn.ModuleList(decoder_layer(config) for _ in range(config.n_decoder_layers))

    def encode(self, prompts: Tensor, mask: Tensor) -> Tokens:
        """Encode prompts: psi = f_slot · f_te · f_e.

        Args:
            prompts: The rows of the prompts' tokens, (G, P, 13).
            mask: Which of them are real, (G, P) bool.

        Returns:
            The preference embedding gamma of each prompt, H tokens; all P without slot attention.
        """
        return self.f_slot(self.f_te(self.f_e(hide(prompts, self.hidden), mask)))

    def decide(self, situations: Situations, preference: Tokens, prompt_of: Tensor) -> Tensor:
        """Score the rows of situations: pi = f_td · f_e, and the pointer.

        Args:
            situations: B situations of N rows.
            preference: The preference embeddings gamma of G prompts.
            prompt_of: The prompt of each situation, (B,) int.

        Returns:
            A score for every row, (B, N).
        """
        n = situations.sets.shape[1]
        rows, mask = situations.with_act_token()  # (B, N + K + 1, 13), (B, N + K + 1)
        inputs = self.f_e(hide(rows, self.hidden), mask)  # (B, N + K + 1, d)
        outputs = self.f_td(inputs, preference, prompt_of)  # (B, N + K + 1, d)
        return point(outputs.features[:, -1], inputs.features[:, :n])  # (B, N)

    def f_e(self, rows: Tensor, mask: Tensor) -> Tokens:
        """Embed the instances: rows (B, N, 13), of which `mask` (B, N) are real, as tokens."""
        return Tokens(self.instances(rows), mask)

    def f_te(self, tokens: Tokens) -> Tokens:
        """Transform a prompt's tokens by self-attention."""
        for layer in self.encoder:
            tokens = layer(tokens)
        return tokens

    def f_slot(self, tokens: Tokens) -> Tokens:
        """Reduce a prompt's tokens to H slots."""
        return self.slots(tokens) if self.slots else tokens

    def f_td(self, tokens: Tokens, preference: Tokens, prompt_of: Tensor) -> Tokens:
        """Transform a situation's tokens by self-attention and cross-attention to gamma."""
        for layer in self.decoder:
            tokens = layer(tokens, preference, prompt_of)
        return tokens
