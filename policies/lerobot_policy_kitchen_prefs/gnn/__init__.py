"""The paper's baseline: a graph network that is told the preference (paper, section 3.1)."""

from .configuration_gnn import GNNConfig
from .modeling_gnn import GNNPolicy
from .processor_gnn import make_gnn_pre_post_processors

__all__ = ["GNNConfig", "GNNPolicy", "make_gnn_pre_post_processors"]
