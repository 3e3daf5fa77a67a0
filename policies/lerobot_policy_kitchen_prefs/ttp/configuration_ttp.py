"""The configuration of TTP: the paper's by default, and a compact one."""

from dataclasses import dataclass, field
from typing import Any, Self

from lerobot.configs import NormalizationMode, PreTrainedConfig
from lerobot.optim import LRSchedulerConfig, OptimizerConfig, SGDConfig

from kitchen_prefs.instances import DECISION, EXTENTS, POSE

from ..common.lerobot_features import check_sets_and_poses, has_descriptions
from ..common.training_presets import check_one_optimizer
from .scheduler import ExponentialDecaySchedulerConfig

# The columns of each attribute.
ATTRIBUTES = {"pose": POSE, "category": EXTENTS, "time": slice(DECISION, DECISION + 1)}
# Size of the embedding of colour, material and soil, where dishes have them. No field, as a field
# would change the fingerprints of all checkpoints of the first tier.
DIM_DESCRIPTION = 32
MAX_DECISIONS = 256  # more than the longest episode has, `environment.MAX_EPISODE_STEPS`


@PreTrainedConfig.register_subclass("ttp")
@dataclass
class TTPConfig(PreTrainedConfig):
    """Configuration of the Transformer Task Planner (paper, section 2 and appendix "Training").

    `TTPConfig.paper()` and `TTPConfig.compact()` are the two that the recipes train.

    Attributes:
        prompt_tokens: "states" makes the prompt's tokens from all rows of all decisions, with an
            ACT token after each (the paper); "chosen" from the chosen row of each decision, some
            forty tokens instead of a thousand; "final" from the dishes in the racks in the end,
            without order and time.
        relabel: Whether training permutes the categories, in prompt and situation together.
        rounds: With how many prompts each pick decision of a batch is paired.
        dim_pose: Size of the pose embedding.
        dim_extents: Size of the category embedding.
        dim_time: Size of the time embedding.
        dim_marker: Size of the object-or-place embedding.
        dim_feedforward: Hidden size of the feed-forward layers.
        n_heads: Attention heads of each layer.
        n_encoder_layers: Layers of the prompt encoder.
        n_decoder_layers: Layers of the situation decoder.
        use_slots: Whether slot attention reduces the encoded prompt to `num_slots` tokens.
        num_slots: Length H of the preference embedding.
        slot_iterations: Iterations of slot attention.
        context_history: The number of earlier decisions whose objects the network sees beside those
            of the present one (paper, appendix).
        hidden: Attributes of instances that the network does not see, of "pose", "category" and
            "time" (paper, table "Attribute Ablations").
        pose_encoding: "fourier" encodes a pose by Fourier features (the paper), "linear" by its
            numbers.
        extents_encoding: "fourier" encodes the extents by Fourier features (the paper), "linear" by
            their numbers, "label" by the nearest category.
        time_encoding: "table" looks the decision's index up (the paper); "fourier" encodes it by
            Fourier features, so that an index that training never saw has an embedding too.
        situation_time: Whether the situation's rows contain the decision's index, as the paper's
            do.
        pre_norm: Whether layers normalise before each sub-layer instead of after it.
        pointer: "inputs" compares the ACT token's output with the embeddings of the rows (the
            paper); "outputs" with learned projections of the decoder's outputs at the rows.
        geometric_attention: Whether attention depends on how near two instances are in size and
            position.
        clashes: Whether a collision model of learned shapes predicts which places are blocked.
        failures: Whether the network sees which choices have just failed.
        recognise: Whether observations are denoised by snapping to known extents and poses.
        dtype: "float32", or "bfloat16" for LeRobot's mixed precision in training.
        optimizer: What trains the policy, and trained a checkpoint; None is the paper's optimiser,
            which the fields `optimizer_...` describe.
        scheduler: The schedule that belongs to `optimizer`; None keeps its learning rate.
    """

    normalization_mapping: dict[str, NormalizationMode] = field(
        default_factory=lambda: dict.fromkeys(
            ("STATE", "ENV", "ACTION"), NormalizationMode.IDENTITY
        )
    )

    # The prompt and its pairing with situations.
    prompt_tokens: str = "states"
    relabel: bool = False
    rounds: int = 1

    # Architecture: 128 + 64 + 32 + 32 = 256 (paper, appendix "Training").
    dim_pose: int = 128
    dim_extents: int = 64
    dim_time: int = 32
    dim_marker: int = 32
    dim_feedforward: int = 512
    n_heads: int = 2
    n_encoder_layers: int = 2
    n_decoder_layers: int = 2
    use_slots: bool = True
    num_slots: int = 50
    slot_iterations: int = 3

    # The encoders of attributes, as the paper varies them.
    context_history: int = 0
    hidden: list[str] = field(default_factory=list)
    pose_encoding: str = "fourier"
    extents_encoding: str = "fourier"
    time_encoding: str = "table"

    # Departures from the paper, off by default.
    situation_time: bool = True
    pre_norm: bool = False
    pointer: str = "inputs"
    geometric_attention: bool = False
    clashes: bool = False
    failures: bool = False
    recognise: bool = False
    dtype: str = "float32"

    # Training preset (paper, appendix "Training"). The paper names no gradient clipping;
    # LeRobot clips at a norm of 10 unless the optimiser is given otherwise.
    optimizer_lr: float = 0.01
    optimizer_momentum: float = 0.9
    optimizer_dampening: float = 0.1
    optimizer_weight_decay: float = 1e-4
    optimizer: OptimizerConfig | None = None
    scheduler: LRSchedulerConfig | None = None

    def __post_init__(self) -> None:
        super().__post_init__()
        check_one_optimizer(self)
        for name, choices in (
            ("prompt_tokens", ("states", "chosen", "final")),
            ("pose_encoding", ("fourier", "linear")),
            ("extents_encoding", ("fourier", "linear", "label")),
            ("time_encoding", ("table", "fourier")),
            ("pointer", ("inputs", "outputs")),
            ("dtype", ("float32", "bfloat16")),
        ):
            if getattr(self, name) not in choices:
                raise ValueError(f"{name} is {getattr(self, name)!r}; it must be one of {choices}.")
        unknown = sorted(set(self.hidden) - set(ATTRIBUTES))
        if unknown:
            raise ValueError(f"hidden names {unknown[0]!r}; it may name {tuple(ATTRIBUTES)}.")
        if self.dtype == "bfloat16" and (self.clashes or self.geometric_attention):
            raise ValueError(
                "clashes and geometric_attention compare millimetres, which bfloat16 rounds away; "
                "set dtype to float32."
            )
        if self.context_history < 0:
            raise ValueError("context_history counts decisions; it is at least 0.")
        if self.context_history and (self.relabel or not self.situation_time):
            raise ValueError(
                "With a context_history, relabel must be off, as it does not change the history, "
                "and situation_time on, as it distinguishes the history from the present."
            )
        if self.dim % self.n_heads:
            raise ValueError(f"{self.n_heads} heads cannot share {self.dim} dimensions equally.")
        if self.rounds < 1:
            raise ValueError("rounds counts the prompts of a pick decision; it is at least 1.")

    @classmethod
    def paper(cls, **changes: Any) -> Self:
        """The paper's network and training, which are the defaults (recipe `ttp_paper`).

        Args:
            **changes: Fields that differ.

        Returns:
            The configuration.
        """
        return cls(**changes)

    @classmethod
    def compact(cls, **changes: Any) -> Self:
        """A network of half the size that reads short prompts (recipe `ttp_quick`, with reasons).

        Args:
            **changes: Fields that differ.

        Returns:
            The configuration.
        """
        return cls(**COMPACT | changes)

    @property
    def departs_from_paper(self) -> bool:
        """Whether the network needs what `compact_network` adds to the paper's."""
        return (
            not self.situation_time
            or self.pre_norm
            or self.pointer != "inputs"
            or self.geometric_attention
            or self.clashes
            or self.failures
        )

    @property
    def dim(self) -> int:
        """The size d of an instance's embedding."""
        description = DIM_DESCRIPTION if self.described else 0
        return self.dim_pose + self.dim_extents + self.dim_time + self.dim_marker + description

    @property
    def described(self) -> bool:
        """Whether the sets are of the second tier, whose dishes are described."""
        return has_descriptions(self)

    def get_optimizer_preset(self) -> OptimizerConfig:
        """The optimiser that trained the checkpoint, or else the paper's."""
        return self.optimizer or SGDConfig(
            lr=self.optimizer_lr,
            momentum=self.optimizer_momentum,
            dampening=self.optimizer_dampening,
            weight_decay=self.optimizer_weight_decay,
        )

    def get_scheduler_preset(self) -> LRSchedulerConfig | None:
        """The schedule of `optimizer`, or else the paper's: 0.9995 per 10 updates."""
        return self.scheduler if self.optimizer else ExponentialDecaySchedulerConfig()

    def validate_features(self) -> None:
        """Check that the inputs contain sets of instances and the outputs poses.

        Raises:
            ValueError: If a feature is missing or has another shape.
        """
        check_sets_and_poses(self)
        if self.type == "ttp" and self.described and self.relabel:
            raise ValueError(
                "relabel permutes the categories of the first tier; set it to false for the second."
            )

    @property
    def observation_delta_indices(self) -> list[int] | None:
        """The present decision, and `context_history` earlier ones."""
        return list(range(-self.context_history, 1)) if self.context_history else None

    @property
    def action_delta_indices(self) -> None:
        """One decision at a time."""
        return None

    @property
    def reward_delta_indices(self) -> None:
        """No rewards are read."""
        return None


# What `TTPConfig.compact` changes: eleven choices, and the sizes.
COMPACT: dict[str, Any] = {
    "prompt_tokens": "chosen",
    "use_slots": False,
    "relabel": True,
    "rounds": 3,
    "geometric_attention": True,
    "pre_norm": True,
    "pointer": "outputs",
    "time_encoding": "fourier",
    "situation_time": False,
    "clashes": True,
    "failures": True,
    "dim_pose": 64,
    "dim_extents": 32,
    "dim_time": 16,
    "dim_marker": 16,
    "dim_feedforward": 256,
    "n_heads": 4,
}
