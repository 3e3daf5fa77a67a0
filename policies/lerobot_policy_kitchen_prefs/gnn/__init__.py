"""The paper's baseline: a graph network with the preference as an input (paper, section 3.1).

LeRobot finds `modeling_gnn` by its name; importing it takes seconds because of torch-geometric.
"""

from .configuration_gnn import GNNConfig
from .processor_gnn import make_gnn_pre_post_processors

__all__ = ["GNNConfig", "make_gnn_pre_post_processors"]
