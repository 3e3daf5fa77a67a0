"""Sets of instances as graphs: every instance is a node, every two of a set are connected.

Sets have from 4 to some 70 rows, so a batch is packed into one graph without padding:

    sets     a b c -   d e - -      (B, N), two sets padded to four rows
    nodes    a b c d e              (V,)
    graph_of 0 0 0 1 1
    edges    aa ab ac ba bb bc ca cb cc dd de ed ee
"""

from typing import NamedTuple, Self

import torch
from torch import Tensor


class Graphs(NamedTuple):
    """The fully connected graphs of B sets, packed into one.

    Attributes:
        is_node: Which rows of the sets are nodes, (B, N) bool.
        graph_of: The graph of each node, (V,) int64.
        edges: The nodes from which and to which each edge goes, a node to itself, too, (2, E)
            int64; torch-geometric's `edge_index`.
    """

    is_node: Tensor
    graph_of: Tensor
    edges: Tensor

    @classmethod
    def connect(cls, is_node: Tensor) -> Self:
        """Connect the rows, those of (B, N) bool, of each set."""
        number = (is_node.flatten().cumsum(0) - 1).view_as(is_node)  # (B, N), each node's
        b, to, origin = (is_node[:, :, None] & is_node[:, None]).nonzero(as_tuple=True)  # (E,) each
        edges = torch.stack([number[b, origin], number[b, to]])  # (2, E)
        return cls(is_node, is_node.nonzero()[:, 0], edges)

    def pack(self, rows: Tensor) -> Tensor:
        """What belongs to the nodes, (B, N, ...) -> (V, ...)."""
        return rows[self.is_node]

    def unpack(self, nodes: Tensor) -> Tensor:
        """The nodes back in their sets, zeros where there is none, (V, d) -> (B, N, d)."""
        sets = nodes.new_zeros(*self.is_node.shape, nodes.shape[-1])
        sets[self.is_node] = nodes
        return sets
