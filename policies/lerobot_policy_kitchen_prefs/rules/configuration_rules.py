"""Configuration of the rules."""

from dataclasses import dataclass, field

from lerobot.configs import NormalizationMode, PreTrainedConfig
from lerobot.optim import AdamWConfig, OptimizerConfig
from lerobot.utils.constants import OBS_STATE

from kitchen_prefs.envs.lerobot_env import OBS_INSTANCES, OBS_PREFERENCE, OBS_PROMPT
from kitchen_prefs.instances import DESCRIBED_COLUMNS
from kitchen_prefs.people.yardsticks import YARDSTICKS
from kitchen_prefs.utils.suggestions import suggest

# The rules of the second tier are its yardsticks, by observations alone.
PEOPLE_RULES = {f"people_{name}": yardstick for name, yardstick in YARDSTICKS.items()}
NEEDS = {
    "random": (OBS_INSTANCES,),
    "promptless": (OBS_INSTANCES,),
    "majority": (OBS_INSTANCES,),
    "nearest": (OBS_INSTANCES, OBS_PROMPT),
    "symbolic": (OBS_INSTANCES, OBS_PROMPT),
    "bayes": (OBS_INSTANCES, OBS_PROMPT),
    "expert": (OBS_INSTANCES, OBS_PREFERENCE),
    **dict.fromkeys(PEOPLE_RULES, (OBS_INSTANCES, OBS_PROMPT, OBS_STATE)),
}


@PreTrainedConfig.register_subclass("rules")
@dataclass
class RulesConfig(PreTrainedConfig):
    """The configuration of the rules.

    Attributes:
        rule: "random" chooses any row; "majority" follows the most frequent training preference;
            "nearest" the training preference that explains the prompt best; "symbolic" the
            preference that it infers from the prompt; "promptless" the exact posterior over all
            2 x 7! preferences given the session's dishes alone (the floor); "bayes" the posterior
            given the prompt, too (the ceiling); "expert" the label (privileged track). On the
            second tier, "random" and the yardsticks of `kitchen_prefs.people.yardsticks`:
            "people_promptless" (the floor), "people_category", "people_zone", "people_similar",
            "people_tree" and "people_bayes" (the ceiling).

    Raises:
        ValueError: If the rule is unknown.
    """

    rule: str = "symbolic"
    device: str | None = "cpu"
    push_to_hub: bool = False
    # Required by LeRobot's default processors; a rule reads poses unnormalised.
    normalization_mapping: dict[str, NormalizationMode] = field(
        default_factory=lambda: dict.fromkeys(
            ("STATE", "ENV", "ACTION"), NormalizationMode.IDENTITY
        )
    )

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.rule not in NEEDS:
            raise ValueError(f"There is no rule {self.rule!r}. {suggest(self.rule, NEEDS)}")

    def validate_features(self) -> None:
        """Check that the observation contains what the rule reads.

        Raises:
            ValueError: If a key is missing.
        """
        for key in NEEDS[self.rule]:
            if key not in (self.input_features or {}):
                hint = " Give --track or --env.track=privileged." if key == OBS_PREFERENCE else ""
                raise ValueError(
                    f"The rule {self.rule!r} needs {key!r}, which the observation does not "
                    f"contain.{hint}"
                )

    @property
    def track(self) -> str:
        """The track whose observations the policy needs; `kitchen-prefs evaluate` reads it."""
        return "privileged" if self.rule == "expert" else "standard"

    @property
    def observation_delta_indices(self) -> None:
        """One decision at a time."""
        return None

    @property
    def action_delta_indices(self) -> None:
        """One action at a time."""
        return None

    @property
    def reward_delta_indices(self) -> None:
        """No rewards are read."""
        return None

    def check_tier(self, columns: int) -> None:
        """Check that observed sets are of the rule's tier; "random" takes both.

        Args:
            columns: The columns of the sets' rows.

        Raises:
            ValueError: If they are not.
        """
        of_people, for_people = columns == DESCRIBED_COLUMNS, self.rule in PEOPLE_RULES
        if self.rule != "random" and of_people != for_people:
            tier = "second" if for_people else "first"
            fitting = [rule for rule in NEEDS if (rule in PEOPLE_RULES) == of_people]
            raise ValueError(
                f"The rule {self.rule!r} is for splits of the {tier} tier; for this one there are "
                f"{', '.join(fitting)}."
            )

    def get_optimizer_preset(self) -> OptimizerConfig:
        """Required by LeRobot; a rule has nothing to optimise."""
        return AdamWConfig()

    def get_scheduler_preset(self) -> None:
        """No schedule."""
        return None
