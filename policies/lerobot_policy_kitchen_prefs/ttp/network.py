"""The network: prompt encoder psi and situation decoder pi (paper, section 2.1)."""

import torch
import torch.nn.functional as F
from torch import Tensor, nn

from kitchen_prefs.instances import COLUMNS, DECISION, EXTENTS, IS_OBJECT, POSITION

from ..common.collision_model import CollisionModel, attended_rows
from ..common.failed_choices import FailedRows, lowered
from ..common.instance_sets import indices_of, is_real, take
from .attention import Tokens
from .configuration_ttp import ATTRIBUTES, TTPConfig
from .encoders import InstanceEncoder
from .pointers import make_pointer
from .situations import Situations
from .slot_attention import SlotAttention
from .transformer import DecoderLayer, EncoderLayer


class TTPNetwork(nn.Module):
    """psi and pi, trained together; one instance encoder serves both."""

    def __init__(self, config: TTPConfig) -> None:
        """Make the network of a configuration."""
        super().__init__()
        self.hidden = columns_of(config.hidden)
        self.hidden_of_situations = (
            self.hidden if config.situation_time else [*self.hidden, DECISION]
        )
        self.instances = InstanceEncoder(config)
        self.encoder = nn.ModuleList(EncoderLayer(config) for _ in range(config.n_encoder_layers))
        self.encoder_norm = final_norm(config)
        self.slots = SlotAttention(config) if config.use_slots else None
        self.decoder = nn.ModuleList(DecoderLayer(config) for _ in range(config.n_decoder_layers))
        self.decoder_norm = final_norm(config)
        self.pointer = make_pointer(config)
        self.failures = FailedRows(config.dim) if config.failures else None
        self.clashes = CollisionModel() if config.clashes else None

    def encode(self, prompts: Tensor, mask: Tensor) -> Tokens:
        """psi: encode prompts.

        Args:
            prompts: The rows of the prompts' tokens, (G, P, 13).
            mask: Which of them are real, (G, P) bool.

        Returns:
            The preference embedding gamma of each prompt, H tokens: the slots or, without, all.
        """
        tokens = self._embed(hide(prompts, self.hidden), mask)
        for layer in self.encoder:
            tokens = layer(tokens)
        tokens = tokens.with_features(self.encoder_norm(tokens.features))
        return self.slots(tokens) if self.slots else tokens

    def decide(self, situations: Situations, preference: Tokens, prompt_of: Tensor) -> Tensor:
        """pi: score the rows of situations.

        The tokens are those of the set, then those of the history, then the ACT token.

        Args:
            situations: B situations of N rows.
            preference: The preference embeddings of G prompts.
            prompt_of: The prompt of each situation, (B,) int.

        Returns:
            A score for every row, (B, N).
        """
        rows = torch.cat([situations.sets, situations.history], dim=1)  # (B, N + H, 13)
        act = rows.new_zeros(len(rows), 1, rows.shape[-1])
        shown = hide(torch.cat([rows, act], dim=1), self.hidden_of_situations)
        seen = attended_rows(rows) if self.clashes else is_real(rows)  # (B, N + H)
        inputs = tokens = self._embed(shown, F.pad(seen, (0, 1), value=True))
        count = situations.sets.shape[1]
        if self.failures:
            marks = F.pad(situations.failed, (0, shown.shape[1] - count))  # (B, N + H + 1)
            tokens = tokens.with_features(self.failures.mark(tokens.features, marks))
        outputs = self._decode(tokens, preference, prompt_of)  # (B, N + H + 1, d)
        scores = self.pointer(outputs[:, -1], inputs.features[:, :count], outputs[:, :count])
        if self.clashes:
            free = self.clashes(shown[:, :count])  # (B, N), log-probabilities
            # Added, they teach shapes even where what is surely blocked lies at the bottom.
            scores = free + lowered(scores, 1 - free.exp(), situations.sets)
        if self.failures:
            shares = self.failures.shares(outputs[:, :count], situations.failed)
            scores = lowered(scores, shares, situations.sets)
        return scores

    def _decode(self, tokens: Tokens, preference: Tokens, prompt_of: Tensor) -> Tensor:
        """The decoder's outputs at B sets of N tokens, zeros where it does not look, (B, N, d)."""
        index, mask = indices_of(tokens.mask)  # (B, M) each
        looked_at = Tokens(take(tokens.features, index), mask, take(tokens.geometry, index))
        for layer in self.decoder:
            looked_at = layer(looked_at, preference, prompt_of)
        outputs = self.decoder_norm(looked_at.features) * mask[..., None]  # (B, M, d)
        everywhere = outputs.new_zeros(tokens.features.shape)
        return everywhere.scatter(1, index[..., None].expand_as(outputs), outputs)

    def _embed(self, rows: Tensor, mask: Tensor) -> Tokens:
        geometry = rows[..., [*range(EXTENTS.start, POSITION.stop), IS_OBJECT]]  # (B, N, 7)
        return Tokens(self.instances(rows), mask, geometry)


def final_norm(config: TTPConfig) -> nn.Module:
    """Make the normalisation after the last layer, which pre-norm layers need."""
    return nn.LayerNorm(config.dim) if config.pre_norm else nn.Identity()


def columns_of(attributes: list[str]) -> list[int]:
    """The columns of attributes."""
    return [column for name in attributes for column in range(COLUMNS)[ATTRIBUTES[name]]]


def hide(rows: Tensor, columns: list[int]) -> Tensor:
    """Rows, (..., 13), with zeros in some columns."""
    return rows.index_fill(-1, torch.tensor(columns, dtype=torch.long, device=rows.device), 0)
