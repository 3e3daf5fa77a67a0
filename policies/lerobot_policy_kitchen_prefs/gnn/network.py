"""The graph network: instances with the preference as an input attend to each other and get scores.

The defaults are the paper's (appendix "Baseline: GNN"). What departs from them has a switch in
`GNNConfig`.
"""

from typing import NamedTuple

import torch
from torch import Tensor, nn
from torch.nn import functional as F
from torch_geometric.nn import DenseGATConv
from torch_geometric.nn.aggr import AttentionalAggregation, MeanAggregation

from kitchen_prefs.envs.kitchen_env import MAX_EPISODE_STEPS
from kitchen_prefs.instances import (
    DECISION,
    EXTENTS,
    IS_OBJECT,
    POSE,
    POSITION,
    QUATERNION,
    choosable,
    is_real,
)
from kitchen_prefs.preferences import TWELVE

from ..common.collision_model import CollisionModel, attended_rows
from ..common.failed_choices import FailureEmbedding
from ..common.fourier_features import (
    EXTENTS_RANGE,
    FREQUENCIES,
    POSITION_RANGE,
    QUATERNION_RANGE,
    FourierFeatures,
)
from ..common.instance_sets import length_buckets
from ..common.score_correction import correct_scores
from .configuration_gnn import GNNConfig

ATTRIBUTES = [*range(EXTENTS.start, POSE.stop), IS_OBJECT]  # with the time, the paper's 12
EXCLUDED = -1e8  # the score of a row that may not be chosen: probability 0, but a finite gradient


class RowScores(NamedTuple):
    """The network's outputs for B sets.

    Attributes:
        scores: A score for every row, (B, N); EXCLUDED for rows that the decision may not choose.
        summary: The nodes of each set, aggregated, (B, d).
    """

    scores: Tensor
    summary: Tensor


class GNNetwork(nn.Module):
    """Graph attention over the fully connected graph of the visible instances.

        scores (B, N)
          ▲
        correction by collisions and failed choices, where configured
          ▲
        readout of each node, where configured with the summary of all nodes (B, d)
          ▲
        layers of graph attention (B, N, d)
          ▲
        attributes of the instance || one-hot of the preference, projected (B, N, d)

    `clashes` and `failures` are the names of weights in checkpoints.
    """

    def __init__(self, config: GNNConfig) -> None:
        """Make the network of a configuration."""
        super().__init__()
        self.dim = config.dim
        self.inputs = NodeInputs(config)
        layer = ResidualLayer if config.pre_norm else PlainLayer
        self.layers = nn.ModuleList(layer(config) for _ in range(config.n_layers))
        self.norm = nn.LayerNorm(config.dim) if config.pre_norm else nn.Identity()
        has_pointer = config.readout == "pointer"
        self.summarise = (
            AttentionalAggregation(nn.Linear(config.dim, 1)) if has_pointer else MeanAggregation()
        )
        self.readout = Pointer(config.dim) if has_pointer else LinearReadout(config.dim)
        self.failures = FailureEmbedding(config.dim) if config.failures else None
        self.clashes = CollisionModel() if config.clashes else None

    def forward(self, sets: Tensor, failed: Tensor, labels: Tensor) -> RowScores:
        """Score the rows of sets.

        Args:
            sets: Sets, zero-padded, (B, N, 13).
            failed: Which rows have just failed, (B, N) bool.
            labels: The preferences' labels, (B,) int64.

        Returns:
            The rows' scores and the sets' summaries.
        """
        scores = sets.new_full(sets.shape[:2], EXCLUDED)
        summary = sets.new_zeros(len(sets), self.dim)
        for bucket in length_buckets(sets):
            n = int(is_real(sets[bucket]).any(dim=0).nonzero().max()) + 1  # the rest is padding
            row_scores = self._score_rows(sets[bucket, :n], failed[bucket, :n], labels[bucket])
            scores[bucket, :n], summary[bucket] = row_scores
        return RowScores(scores, summary)

    def _score_rows(self, sets: Tensor, failed: Tensor, labels: Tensor) -> RowScores:
        is_node = attended_rows(sets) if self.clashes else is_real(sets)  # (B, N)
        nodes = self.inputs(sets, one_hot(labels))  # (B, N, d)
        if self.failures:
            nodes = self.failures.embed(nodes, failed)
        for layer in self.layers:
            nodes = layer(nodes, is_node)  # (B, N, d)
        nodes = self.norm(nodes)
        of_set = is_node.nonzero()[:, 0]  # (V,)
        summary = self.summarise(nodes[is_node], of_set, dim_size=len(sets))  # (B, d)
        scores = correct_scores(
            self.readout(nodes, summary),  # (B, N)
            sets,
            self.clashes(sets) if self.clashes else None,
            self.failures.penalties(nodes, failed) if self.failures else None,
        )
        return RowScores(scores.masked_fill(~choosable(sets), EXCLUDED), summary)


def one_hot(labels: Tensor) -> Tensor:
    """The twelve-way one-hot of preferences (paper, appendix "Baseline: GNN").

    Twelve inputs can name no other preference: every other preference has zeros, and the network
    knows nothing of it.

    Args:
        labels: The preferences' labels, (B,) int64.

    Returns:
        The one-hots, (B, 12) float32.
    """
    return (labels[:, None] == torch.arange(len(TWELVE), device=labels.device)).float()


class NodeInputs(nn.Module):
    """The nodes' features: the attributes of instances and the preference, projected."""

    def __init__(self, config: GNNConfig) -> None:
        """Make the projection of the paper's 24 inputs, or of Fourier features beside them."""
        super().__init__()
        self.time = config.time
        self.fourier = AttributeFourierFeatures() if config.encoding == "fourier" else None
        added = self.fourier.size if self.fourier else 0
        self.project = nn.Linear(1 + len(ATTRIBUTES) + len(TWELVE) + added, config.dim)

    def forward(self, sets: Tensor, preference: Tensor) -> Tensor:
        """Embed the rows of sets, (B, N, 13), and their preferences, (B, 12), as (B, N, d)."""
        # The paper names no unit of time; whole decisions would outweigh all other inputs.
        time = sets[..., DECISION, None] / MAX_EPISODE_STEPS * self.time  # (B, N, 1)
        preference = preference[:, None].expand(-1, sets.shape[1], -1)  # (B, N, 12)
        inputs = [time, sets[..., ATTRIBUTES], preference]
        if self.fourier:
            inputs.append(self.fourier(sets))  # (B, N, 160)
        return self.project(torch.cat(inputs, dim=-1))


class AttributeFourierFeatures(nn.Module):
    """Fourier features of extents, position and quaternion."""

    size = (POSE.stop - EXTENTS.start) * 2 * FREQUENCIES

    def __init__(self) -> None:
        """Make Fourier features with the range of each as the longest wavelength."""
        super().__init__()
        self.extents = FourierFeatures(EXTENTS_RANGE)
        self.position = FourierFeatures(POSITION_RANGE)
        self.quaternion = FourierFeatures(QUATERNION_RANGE)

    def forward(self, rows: Tensor) -> Tensor:
        """Expand rows, (..., 13), to (..., 10 * 2 * FREQUENCIES)."""
        features = (
            self.extents(rows[..., EXTENTS]),
            self.position(rows[..., POSITION]),
            self.quaternion(rows[..., QUATERNION]),
        )
        return torch.cat(features, dim=-1)


class GraphAttention(nn.Module):
    """Attention over the fully connected graph of each set (Velickovic et al., 2018)."""

    def __init__(self, config: GNNConfig) -> None:
        """Make the layer; its heads share the size of a node."""
        super().__init__()
        size = config.dim // config.n_heads
        self.layer = DenseGATConv(config.dim, size, heads=config.n_heads)

    def forward(self, nodes: Tensor, is_node: Tensor) -> Tensor:
        """Attend from all rows of a set to its nodes, themselves included.

        Args:
            nodes: The rows, (B, N, d).
            is_node: Which of them are nodes, (B, N) bool, at least one of each set.

        Returns:
            The attended values, (B, N, d).
        """
        adjacency = is_node[:, None].expand(-1, nodes.shape[1], -1)  # (B, N, N)
        return self.layer(nodes, adjacency, add_loop=False)


class PlainLayer(nn.Module):
    """Attention beside a skip connection, and an ELU (Velickovic et al., 2018).

    In a fully connected graph all nodes have the same neighbours. Without the skip connection they
    would be almost equal after one layer, and so would their scores.
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
            summary: The nodes of each set, aggregated, (B, d); not used here.

        Returns:
            The scores, (B, N).
        """
        return self.score(outputs)[..., 0]


class Pointer(nn.Module):
    """The dot product of each node with the summary of its set, as in TTP."""

    def __init__(self, dim: int) -> None:
        """Make the projections of `dim` dimensions."""
        super().__init__()
        self.query = nn.Linear(dim, dim)
        self.key = nn.Linear(dim, dim)

    def forward(self, outputs: Tensor, summary: Tensor) -> Tensor:
        """Score rows; arguments and result are those of `LinearReadout.forward`."""
        scale = outputs.shape[-1] ** -0.5
        return torch.einsum("bd,bnd->bn", self.query(summary), self.key(outputs)) * scale
