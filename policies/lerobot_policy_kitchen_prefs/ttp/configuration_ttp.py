"""What can be chosen about TTP. The defaults are the paper's."""

from dataclasses import dataclass, field

from lerobot.configs import NormalizationMode, PreTrainedConfig
from lerobot.optim import SGDConfig

from kitchen_prefs.instances import DECISION, EXTENTS, POSE

from ..common.lerobot_features import check_sets_and_poses
from .scheduler import ExponentialDecaySchedulerConfig

# The columns of each attribute.
ATTRIBUTES = {"pose": POSE, "category": EXTENTS, "time": slice(DECISION, DECISION + 1)}


@PreTrainedConfig.register_subclass("ttp")
@dataclass
class TTPConfig(PreTrainedConfig):
    """Configuration of the Transformer Task Planner (paper, section 2 and appendix "Training").

    Attributes:
        prompt_tokens: "states" makes the prompt's tokens from all rows of all decisions, with an
            ACT token after each (the paper); "chosen" from the chosen row of each decision alone,
            some forty tokens instead of a thousand; "final" from the dishes in the racks as they
            stand in the end, without order and time.
        relabel: Whether training permutes the categories, in prompt and situation together, and
            lets dishes stand in the racks as their new category does.
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
        slot_iterations: Rounds of slot attention.
        context_history: The number k of earlier decisions whose objects are seen beside those of
            the present one (paper, appendix).
        hidden: Attributes of instances that the network does not see, of "pose", "category" and
            "time" (paper, table "Attribute Ablations").
        pose_encoding: "fourier" expands a pose into waves (the paper); "linear" takes its numbers.
        extents_encoding: "fourier" expands the extents into waves (the paper); "linear" takes their
            numbers; "label" only which category they are nearest to.
        time_encoding: "table" looks the decision's index up (the paper); "fourier" expands it, so
            that an index that training never saw has an embedding too.
        situation_time: Whether the situation's rows tell the decision's index, as the paper's do.
        pre_norm: Whether layers normalise before each sub-layer instead of after it.
        pointer: "inputs" compares the ACT token's output with the embeddings of the rows (the
            paper); "outputs" with learned projections of the decoder's outputs at the rows.
        geometric_attention: Whether attention also sees how alike and how near instances are.
        clashes: Whether learned shapes alone say which places the objects of a set block.
        failures: Whether the network sees which rows it has just chosen in vain.
        recognise: Whether dishes that are seen noisily are taken for the known ones that they
            resemble most.
        dtype: "float32", or "bfloat16" for LeRobot's mixed precision in training.
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

    def __post_init__(self) -> None:
        super().__post_init__()
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
            raise ValueError(f"hidden names {unknown[0]!r}; attributes are {tuple(ATTRIBUTES)}.")
        if self.dtype == "bfloat16" and (self.clashes or self.geometric_attention):
            raise ValueError(
                "clashes and geometric_attention compare millimetres, which bfloat16 rounds away; "
                "leave dtype at float32."
            )
        if self.context_history < 0:
            raise ValueError("context_history counts decisions; it is at least 0.")
        if self.context_history and (self.relabel or not self.situation_time):
            raise ValueError(
                "With a context_history, relabel must be off, as it changes the present alone, and "
                "situation_time on, as it tells the past from the present."
            )
        if self.dim % self.n_heads:
            raise ValueError(f"{self.n_heads} heads cannot share {self.dim} dimensions equally.")
        if self.rounds < 1:
            raise ValueError("rounds counts the prompts of a pick decision; it is at least 1.")

    @property
    def dim(self) -> int:
        """The size d of an instance's embedding."""
        return self.dim_pose + self.dim_extents + self.dim_time + self.dim_marker

    def get_optimizer_preset(self) -> SGDConfig:
        """The paper's optimiser."""
        return SGDConfig(
            lr=self.optimizer_lr,
            momentum=self.optimizer_momentum,
            dampening=self.optimizer_dampening,
            weight_decay=self.optimizer_weight_decay,
        )

    def get_scheduler_preset(self) -> ExponentialDecaySchedulerConfig:
        """The paper's schedule: 0.9995 per 10 updates."""
        return ExponentialDecaySchedulerConfig()

    def validate_features(self) -> None:
        """Check that there are sets of instances to look at and poses to return.

        Raises:
            ValueError: If a feature is missing or has another shape.
        """
        check_sets_and_poses(self)

    @property
    def observation_delta_indices(self) -> list[int] | None:
        """TTP looks at one decision, or at `context_history` more."""
        return list(range(-self.context_history, 1)) if self.context_history else None

    @property
    def action_delta_indices(self) -> None:
        """TTP makes one decision."""
        return None

    @property
    def reward_delta_indices(self) -> None:
        """TTP sees no reward."""
        return None
