"""The graph network: instances that know the preference look at each other, then are scored."""

from typing import NamedTuple

import torch
from torch import Tensor, nn
from torch.nn import functional as F
from torch_geometric.nn import DenseGATConv
from torch_geometric.nn.aggr import AttentionalAggregation, MeanAggregation

from kitchen_prefs.envs.environment import MAX_EPISODE_STEPS
from kitchen_prefs.instances import DECISION, EXTENTS, IS_OBJECT, POSE, POSITION, QUATERNION
from kitchen_prefs.preferences import TWELVE

from ..common.collision_model import CollisionModel, attended_rows
from ..common.failed_choices import FailedRows, lowered
from ..common.fourier_features import (
    EXTENTS_RANGE,
    FREQUENCIES,
    POSITION_RANGE,
    QUATERNION_RANGE,
    FourierFeatures,
)
from ..common.instance_sets import choosable, is_real, length_buckets
from .configuration_gnn import GNNConfig

NUMBERS = [*range(EXTENTS.start, POSE.stop), IS_OBJECT]  # with the time the paper's 12 attributes
WAVES = (POSE.stop - EXTENTS.start) * 2 * FREQUENCIES  # of extents, position and quaternion
NEVER = -1e8  # the score of a row that may not be chosen: its probability is 0, its gradient finite


class RowScores(NamedTuple):
    """What the network makes of B sets.

    Attributes:
        scores: A score for every row, (B, N); NEVER for what the decision may not choose.
        summary: All nodes of a set together, (B, d).
    """

    scores: Tensor
    summary: Tensor


class GNNetwork(nn.Module):
    """Graph attention over the fully connected graph of the visible instances."""

    def __init__(self, config: GNNConfig) -> None:
        """Make the network of a configuration."""
        super().__init__()
        self.dim = config.dim
        self.inputs = NodeInputs(config)
        layer = ResidualLayer if config.pre_norm else PlainLayer
        self.layers = nn.ModuleList(layer(config) for _ in range(config.n_layers))
        self.norm = nn.LayerNorm(config.dim) if config.pre_norm else nn.Identity()
        points = config.readout == "pointer"
        self.summarise = (
            AttentionalAggregation(nn.Linear(config.dim, 1)) if points else MeanAggregation()
        )
        self.readout = Pointer(config.dim) if points else LinearReadout(config.dim)
        self.failures = FailedRows(config.dim) if config.failures else None
        self.clashes = CollisionModel() if config.clashes else None

    def forward(self, sets: Tensor, failed: Tensor, labels: Tensor) -> RowScores:
        """Judge the rows of sets.

        Args:
            sets: Sets, zero-padded, (B, N, 13).
            failed: Which rows were just chosen in vain, (B, N) bool.
            labels: The preferences' labels, (B,) int64.

        Returns:
            The rows' scores and the sets' summaries.
        """
        scores = sets.new_full(sets.shape[:2], NEVER)
        summary = sets.new_zeros(len(sets), self.dim)
        for part in length_buckets(sets):
            n = int(is_real(sets[part]).any(dim=0).nonzero().max()) + 1  # the rest is padding
            row_scores = self._score_rows(sets[part, :n], failed[part, :n], labels[part])
            scores[part, :n], summary[part] = row_scores
        return RowScores(scores, summary)

    def _score_rows(self, sets: Tensor, failed: Tensor, labels: Tensor) -> RowScores:
        is_node = attended_rows(sets) if self.clashes else is_real(sets)  # (B, N)
        nodes = self.inputs(sets, one_hot(labels))  # (B, N, d)
        if self.failures:
            nodes = self.failures.mark(nodes, failed)
        for layer in self.layers:
            nodes = layer(nodes, is_node)
        nodes = self.norm(nodes)
        of_set = is_node.nonzero()[:, 0]  # (V,)
        summary = self.summarise(nodes[is_node], of_set, dim_size=len(sets))  # (B, d)
        scores = self.readout(nodes, summary)  # (B, N)
        if self.clashes:
            free = self.clashes(sets)  # (B, N), log-probabilities
            # Added, they teach shapes even where what is surely blocked lies at the bottom.
            scores = free + lowered(scores, 1 - free.exp(), sets)
        if self.failures:
            scores = lowered(scores, self.failures.shares(nodes, failed), sets)
        return RowScores(scores.masked_fill(~choosable(sets), NEVER), summary)


def one_hot(labels: Tensor) -> Tensor:
    """The twelve-way one-hot of preferences (paper, appendix "Baseline: GNN").

    Twelve inputs can name no other preference: whoever is none of the twelve has zeros, and the
    network knows nothing of this person.

    Args:
        labels: The preferences' labels, (B,) int64.

    Returns:
        The one-hots, (B, 12) float32.
    """
    return (labels[:, None] == torch.arange(len(TWELVE), device=labels.device)).float()


class NodeInputs(nn.Module):
    """What a node begins as: its instance's attributes and the preference, projected."""

    def __init__(self, config: GNNConfig) -> None:
        """Make the projection of the paper's 24 inputs, or of waves beside them."""
        super().__init__()
        self.time = config.time
        self.waves = Waves() if config.encoding == "fourier" else None
        size = 1 + len(NUMBERS) + len(TWELVE) + (WAVES if self.waves else 0)
        self.project = nn.Linear(size, config.dim)

    def forward(self, sets: Tensor, told: Tensor) -> Tensor:
        """Embed the rows of sets, (B, N, 13), and their preferences, (B, 12), as (B, N, d)."""
        # The paper names no unit of time; whole decisions would outweigh everything beside them.
        time = sets[..., DECISION, None] / MAX_EPISODE_STEPS * self.time  # (B, N, 1)
        told = told[:, None].expand(-1, sets.shape[1], -1)  # (B, N, 12)
        inputs = [time, sets[..., NUMBERS], told, *([self.waves(sets)] if self.waves else [])]
        return self.project(torch.cat(inputs, dim=-1))


class Waves(nn.Module):
    """Fourier features of extents, position and quaternion."""

    def __init__(self) -> None:
        """Make waves as long as the range of each."""
        super().__init__()
        self.extents = FourierFeatures(EXTENTS_RANGE)
        self.position = FourierFeatures(POSITION_RANGE)
        self.quaternion = FourierFeatures(QUATERNION_RANGE)

    def forward(self, rows: Tensor) -> Tensor:
        """Expand rows, (..., 13), to (..., 10 * 2 * FREQUENCIES)."""
        waves = (
            self.extents(rows[..., EXTENTS]),
            self.position(rows[..., POSITION]),
            self.quaternion(rows[..., QUATERNION]),
        )
        return torch.cat(waves, dim=-1)


class GraphAttention(nn.Module):
    """Attention over the fully connected graph of each set (Velickovic et al., 2018)."""

    def __init__(self, config: GNNConfig) -> None:
        """Make the layer; its heads share the size of a node."""
        super().__init__()
        size = config.dim // config.n_heads
        self.layer = DenseGATConv(config.dim, size, heads=config.n_heads)

    def forward(self, nodes: Tensor, is_node: Tensor) -> Tensor:
        """Let all rows of sets look at the nodes, themselves among them.

        Args:
            nodes: The rows, (B, N, d).
            is_node: Which of them are nodes, (B, N) bool, at least one of each set.

        Returns:
            What they see, (B, N, d).
        """
        everyone = is_node[:, None].expand(-1, nodes.shape[1], -1)  # (B, N, N)
        return self.layer(nodes, everyone, add_loop=False)


class PlainLayer(nn.Module):
    """Attention beside a skip connection, and an ELU (Velickovic et al., 2018).

    In a fully connected graph all nodes have the same neighbours. Without the skip connection they
    would be almost equal after one layer, and no score could tell them apart.
    """

    def __init__(self, config: GNNConfig) -> None:
        """Make a layer of the configured size."""
        super().__init__()
        self.attention = GraphAttention(config)
        self.skip = nn.Linear(config.dim, config.dim, bias=False)

    def forward(self, nodes: Tensor, is_node: Tensor) -> Tensor:
        """Transform rows; arguments and result are those of `GraphAttention.forward`."""
        return F.elu(self.attention(nodes, is_node) + self.skip(nodes))


class ResidualLayer(nn.Module):
    """Attention and a feed-forward network, each normalised before and added (as in TTP)."""

    def __init__(self, config: GNNConfig) -> None:
        """Make a layer of the configured size; the feed-forward network is twice as wide."""
        super().__init__()
        self.attention_norm, self.feedforward_norm = (nn.LayerNorm(config.dim) for _ in range(2))
        self.attention = GraphAttention(config)
        self.feedforward = nn.Sequential(
            nn.Linear(config.dim, 2 * config.dim), nn.GELU(), nn.Linear(2 * config.dim, config.dim)
        )

    def forward(self, nodes: Tensor, is_node: Tensor) -> Tensor:
        """Transform rows; arguments and result are those of `GraphAttention.forward`."""
        nodes = nodes + self.attention(self.attention_norm(nodes), is_node)
        return nodes + self.feedforward(self.feedforward_norm(nodes))


class LinearReadout(nn.Module):
    """The score of a node by itself."""

    def __init__(self, dim: int) -> None:
        """Make a readout of `dim` dimensions."""
        super().__init__()
        self.score = nn.Linear(dim, 1)

    def forward(self, outputs: Tensor, summary: Tensor) -> Tensor:
        """Score rows.

        Args:
            outputs: The nodes in their sets, (B, N, d).
            summary: All nodes of a set together, (B, d); not used here.

        Returns:
            The scores, (B, N).
        """
        return self.score(outputs)[..., 0]


class Pointer(nn.Module):
    """The dot product of the nodes with what they say together, as TTP points."""

    def __init__(self, dim: int) -> None:
        """Make the projections of `dim` dimensions."""
        super().__init__()
        self.query = nn.Linear(dim, dim)
        self.key = nn.Linear(dim, dim)

    def forward(self, outputs: Tensor, summary: Tensor) -> Tensor:
        """Score rows; arguments and result are those of `LinearReadout.forward`."""
        scale = outputs.shape[-1] ** -0.5
        return torch.einsum("bd,bnd->bn", self.query(summary), self.key(outputs)) * scale
