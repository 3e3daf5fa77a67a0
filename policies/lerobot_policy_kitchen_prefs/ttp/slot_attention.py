"""Slot attention: the bottleneck that reduces a prompt to a few tokens (Locatello et al., 2020)."""

import torch
from torch import nn

from .attention import Tokens
from .configuration_ttp import TTPConfig

EPSILON = 1e-8  # a slot that no token wants must not divide by zero (original implementation)


class SlotAttention(nn.Module):
    """f_slot: slots compete for the prompt's tokens, over a few rounds.

    The original draws the slots' start at random. Here the start is learned, so that a prompt
    always gives the same preference embedding.
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
            shares = scores.softmax(dim=1) * prompts.mask[:, None]  # each token is shared out
            total = shares.sum(dim=-1, keepdim=True) + EPSILON  # (G, H, 1)
            updates = shares / total @ values  # (G, H, d)
            slots = self.update(updates.flatten(0, 1), slots.flatten(0, 1)).view_as(slots)
            slots = slots + self.feedforward(slots)
        is_real = torch.ones_like(slots[..., 0], dtype=torch.bool)
        return Tokens(slots, is_real, slots.new_zeros(*slots.shape[:2], prompts.geometry.shape[-1]))
