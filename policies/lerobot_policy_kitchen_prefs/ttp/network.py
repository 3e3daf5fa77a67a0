"""The network: prompt encoder psi and situation decoder pi (paper, section 2.1)."""

import torch
import torch.nn.functional as F
from torch import Tensor, nn

from kitchen_prefs.instances import DECISION, EXTENTS, IS_OBJECT, POSITION

from .attention import Tokens
from .configuration_ttp import TTPConfig
from .encoders import InstanceEncoder
from .pointers import make_pointer
from .slot_attention import SlotAttention
from .transformer import DecoderLayer, EncoderLayer


class TTPNetwork(nn.Module):
    """psi and pi, trained together; one instance encoder serves both."""

    def __init__(self, config: TTPConfig) -> None:
        """Make the network of a configuration."""
        super().__init__()
        self.situation_time = config.situation_time
        self.instances = InstanceEncoder(config)
        self.encoder = nn.ModuleList(EncoderLayer(config) for _ in range(config.n_encoder_layers))
        self.encoder_norm = final_norm(config)
        self.slots = SlotAttention(config) if config.use_slots else None
        self.decoder = nn.ModuleList(DecoderLayer(config) for _ in range(config.n_decoder_layers))
        self.decoder_norm = final_norm(config)
        self.pointer = make_pointer(config)

    def encode(self, prompts: Tensor, mask: Tensor) -> Tokens:
        """psi: encode prompts.

        Args:
            prompts: The rows of the prompts' tokens, (G, P, 13).
            mask: Which of them are real, (G, P) bool.

        Returns:
            The preference embedding gamma of each prompt, H tokens: the slots or, without, all.
        """
        tokens = self._embed(prompts, mask)
        for layer in self.encoder:
            tokens = layer(tokens)
        tokens = tokens.with_features(self.encoder_norm(tokens.features))
        return self.slots(tokens) if self.slots else tokens

    def decide(self, sets: Tensor, mask: Tensor, preference: Tokens, prompt_of: Tensor) -> Tensor:
        """pi: score the rows of situations.

        Args:
            sets: The situations' rows, (B, N, 13).
            mask: Which of them are real, (B, N) bool.
            preference: The preference embeddings of G prompts.
            prompt_of: The prompt of each situation, (B,) int.

        Returns:
            A score for every row, (B, N).
        """
        if not self.situation_time:
            decision = torch.tensor([DECISION], device=sets.device)
            sets = sets.index_fill(-1, decision, 0)
        act = sets.new_zeros(len(sets), 1, sets.shape[-1])
        inputs = self._embed(torch.cat([sets, act], dim=1), F.pad(mask, (0, 1), value=True))
        tokens = inputs
        for layer in self.decoder:
            tokens = layer(tokens, preference, prompt_of)
        outputs = self.decoder_norm(tokens.features)  # (B, N + 1, d)
        return self.pointer(outputs[:, -1], inputs.features[:, :-1], outputs[:, :-1])

    def _embed(self, rows: Tensor, mask: Tensor) -> Tokens:
        geometry = rows[..., [*range(EXTENTS.start, POSITION.stop), IS_OBJECT]]  # (B, N, 7)
        return Tokens(self.instances(rows), mask, geometry)


def final_norm(config: TTPConfig) -> nn.Module:
    """Make the normalisation after the last layer, which pre-norm layers need."""
    return nn.LayerNorm(config.dim) if config.pre_norm else nn.Identity()
