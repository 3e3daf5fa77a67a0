"""The configuration of the graph network. The defaults are the paper's."""

from dataclasses import dataclass, field

from lerobot.configs import FeatureType, NormalizationMode, PolicyFeature, PreTrainedConfig
from lerobot.optim import AdamConfig, LRSchedulerConfig, OptimizerConfig

from kitchen_prefs.envs.lerobot_env import OBS_PREFERENCE

from ..common.lerobot_features import check_sets_and_poses
from ..common.training_presets import check_one_optimizer


@PreTrainedConfig.register_subclass("gnn")
@dataclass
class GNNConfig(PreTrainedConfig):
    """Configuration of the graph network (paper, appendix "Baseline: GNN").

    Attributes:
        dim: Size of a node.
        n_layers: Layers of attention, each with a skip connection. The paper does not say how many;
            its transformer has two.
        n_heads: Attention heads of each layer, which share `dim`. The paper does not say how many;
            its transformer has two.
        encoding: "linear" takes extents and poses as numbers (the paper); "fourier" adds their
            Fourier features, which resolve millimetres.
        time: Whether the inputs contain the decision's index, as the paper's do. Longer sessions
            exceed the indices of training.
        pre_norm: Whether a layer is added to its input and followed by a feed-forward network, with
            layer normalisation before each, instead of being followed by an ELU.
        readout: "linear" scores each node by itself; "pointer" compares it with the summary of all
            nodes.
        clashes: Whether a collision model of learned shapes predicts which places are blocked.
        failures: Whether the network sees which choices have just failed.
        recognise: Whether observations are denoised by snapping to known extents and poses.
        sample: Whether acting samples a row by its probability, as PPO does in training, instead
            of taking the most probable one.
        optimizer: What trains the policy, and trained a checkpoint; None is the paper's optimiser,
            which the fields `optimizer_...` describe.
        scheduler: The schedule that belongs to `optimizer`; None keeps its learning rate.
    """

    normalization_mapping: dict[str, NormalizationMode] = field(
        default_factory=lambda: dict.fromkeys(
            ("STATE", "ENV", "ACTION"), NormalizationMode.IDENTITY
        )
    )

    # Architecture (paper, appendix "Baseline: GNN").
    dim: int = 128
    n_layers: int = 2
    n_heads: int = 2
    encoding: str = "linear"
    time: bool = True

    # Departures from the paper, off by default.
    pre_norm: bool = False
    readout: str = "linear"
    clashes: bool = False
    failures: bool = False
    recognise: bool = False
    sample: bool = False

    # Training preset (paper, appendix "Baseline: GNN").
    optimizer_lr: float = 0.01
    optimizer_weight_decay: float = 1e-3
    optimizer: OptimizerConfig | None = None
    scheduler: LRSchedulerConfig | None = None

    def __post_init__(self) -> None:
        super().__post_init__()
        check_one_optimizer(self)
        for name, choices in (
            ("encoding", ("linear", "fourier")),
            ("readout", ("linear", "pointer")),
        ):
            if getattr(self, name) not in choices:
                raise ValueError(f"{name} is {getattr(self, name)!r}; it must be one of {choices}.")
        for name in ("dim", "n_layers", "n_heads"):
            if getattr(self, name) < 1:
                raise ValueError(f"{name} is {getattr(self, name)}; it must be at least 1.")
        if self.dim % self.n_heads:
            raise ValueError(f"{self.n_heads} heads cannot share {self.dim} dimensions equally.")

    @property
    def track(self) -> str:
        """The track whose observations the policy needs; `kitchen-prefs evaluate` reads it."""
        return "privileged"

    def get_optimizer_preset(self) -> OptimizerConfig:
        """The optimiser that trained the checkpoint, or else the paper's."""
        paper = AdamConfig(lr=self.optimizer_lr, weight_decay=self.optimizer_weight_decay)
        return self.optimizer or paper

    def get_scheduler_preset(self) -> LRSchedulerConfig | None:
        """The schedule of `optimizer`; the paper names none."""
        return self.scheduler

    def validate_features(self) -> None:
        """Check that the inputs contain sets of instances and the outputs poses.

        The preference's label becomes an input, too: observations of the privileged track contain
        it, data sets have it in a column that LeRobot does not take for an observation.

        Raises:
            ValueError: If a feature is missing or has another shape.
        """
        check_sets_and_poses(self)
        assert self.input_features is not None
        self.input_features[OBS_PREFERENCE] = PolicyFeature(FeatureType.STATE, (1,))

    @property
    def observation_delta_indices(self) -> None:
        """One decision at a time."""
        return None

    @property
    def action_delta_indices(self) -> None:
        """One decision at a time."""
        return None

    @property
    def reward_delta_indices(self) -> None:
        """No rewards are read."""
        return None
