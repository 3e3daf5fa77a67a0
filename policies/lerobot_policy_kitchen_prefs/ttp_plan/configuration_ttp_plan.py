"""The configuration of TTP with a plan."""

from dataclasses import dataclass

from lerobot.configs import PreTrainedConfig

from ..ttp.configuration_ttp import COMPACT, TTPConfig


@PreTrainedConfig.register_subclass("ttp_plan")
@dataclass
class PlanTTPConfig(TTPConfig):
    """Configuration of TTP with a plan: the compact network of TTP, and a plan reader before it.

    Of TTP's switches, `clashes`, `failures` and `pointer="outputs"` are always on, and `recognise`,
    `context_history` and further `rounds` off.

    Attributes:
        reader_dim: Size of a dish's features in the plan reader.
        reader_layers: Its layers.
        reader_feedforward: Hidden size of their feed-forward networks.
        reader_dropout: The share of features that its layers drop in training.
        decided: How many samples of a batch teach decisions, which are learned sooner than plans;
            all of them teach plans.
        slip_share: In training, the share of prompts with slips, of which a user makes some.
        own_share: In training, the share of the samples that teach plans alone to which some dishes
            of their own episode are shown too, as more demonstrations would; they are not asked
            about.
    """

    reader_dim: int = 128
    reader_layers: int = 3
    reader_feedforward: int = 384
    reader_dropout: float = 0.1
    decided: int = 32
    slip_share: float = 0.3
    own_share: float = 0.5

    prompt_tokens: str = COMPACT["prompt_tokens"]
    use_slots: bool = COMPACT["use_slots"]
    relabel: bool = COMPACT["relabel"]
    geometric_attention: bool = COMPACT["geometric_attention"]
    pre_norm: bool = COMPACT["pre_norm"]
    pointer: str = COMPACT["pointer"]
    time_encoding: str = COMPACT["time_encoding"]
    situation_time: bool = COMPACT["situation_time"]
    clashes: bool = COMPACT["clashes"]
    failures: bool = COMPACT["failures"]
    dim_pose: int = COMPACT["dim_pose"]
    dim_extents: int = COMPACT["dim_extents"]
    dim_time: int = COMPACT["dim_time"]
    dim_marker: int = COMPACT["dim_marker"]
    dim_feedforward: int = COMPACT["dim_feedforward"]
    n_heads: int = COMPACT["n_heads"]

    def __post_init__(self) -> None:
        super().__post_init__()
        fixed = {
            **{"clashes": True, "failures": True, "pointer": "outputs"},
            **{"recognise": False, "context_history": 0, "rounds": 1},
        }
        for name, value in fixed.items():
            if getattr(self, name) != value:
                raise ValueError(
                    f"{name} is always {value} for --policy.type=ttp_plan; leave it out."
                )

    def validate_features(self) -> None:
        """Check that the inputs contain sets of described dishes and the outputs poses.

        Raises:
            ValueError: If a feature is missing or has another shape.
        """
        super().validate_features()
        if not self.described:
            raise ValueError(
                "--policy.type=ttp_plan reads colours and materials, which the first tier lacks; "
                "use a data set or a split of the second, such as dishwasher-people_train-v2."
            )
