"""The pointer: how the ACT token's output chooses among the rows."""

import torch
from torch import Tensor, nn

from .configuration_ttp import TTPConfig


class InputPointer(nn.Module):
    """The dot product of the ACT token's output with the rows' embeddings (paper, section 2.1)."""

    def forward(self, act: Tensor, inputs: Tensor, outputs: Tensor) -> Tensor:
        """Score rows.

        Args:
            act: The decoder's output at the ACT token, (B, d).
            inputs: The rows' embeddings e_i, (B, N, d).
            outputs: The decoder's outputs at the rows, (B, N, d); not used here.

        Returns:
            The scores, (B, N), divided by the square root of d as in attention. The paper does not
            say so; undivided scores of untrained networks are far from equal.
        """
        return torch.einsum("bd,bnd->bn", act, inputs) * act.shape[-1] ** -0.5


class OutputPointer(nn.Module):
    """The same with learned projections of the decoder's outputs, where rows know of each other."""

    def __init__(self, dim: int) -> None:
        """Make the projections of `dim` dimensions."""
        super().__init__()
        self.query = nn.Linear(dim, dim)
        self.key = nn.Linear(dim, dim)

    def forward(self, act: Tensor, inputs: Tensor, outputs: Tensor) -> Tensor:
        """Score rows; arguments and result are those of `InputPointer.forward`."""
        scale = act.shape[-1] ** -0.5
        return torch.einsum("bd,bnd->bn", self.query(act), self.key(outputs)) * scale


def make_pointer(config: TTPConfig) -> nn.Module:
    """Make the configured pointer."""
    return InputPointer() if config.pointer == "inputs" else OutputPointer(config.dim)
