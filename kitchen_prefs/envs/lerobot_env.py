"""LeRobot's view of the environment: `--env.type=kitchen_prefs --env.task=<split>`."""

from dataclasses import dataclass, field
from typing import Any

import gymnasium
from lerobot.configs import FeatureType, PolicyFeature
from lerobot.envs.configs import EnvConfig
from lerobot.envs.utils import freeze_after_episode_end
from lerobot.utils.constants import ACTION, OBS_ENV_STATE, OBS_STATE

from kitchen_prefs.envs.environment import TRACKS, DishwasherLoading
from kitchen_prefs.envs.spaces import action_space, observation_space
from kitchen_prefs.splits import get_split
from kitchen_prefs.utils.suggestions import suggest

OBS_INSTANCES = "observation.instances"
OBS_PROMPT = "observation.prompt"
OBS_PREFERENCE = "observation.preference"

FEATURES_MAP = {
    ACTION: ACTION,
    "agent_pos": OBS_STATE,
    "environment_state": OBS_ENV_STATE,
    "instances": OBS_INSTANCES,
    "prompt": OBS_PROMPT,
    "preference": OBS_PREFERENCE,
}


# Everything else that the environment shows is of the type STATE.
FEATURE_TYPES = {"environment_state": FeatureType.ENV}


def features_of(track: str, flat: bool = True) -> dict[str, PolicyFeature]:
    """The environment's raw keys on a track, as LeRobot's features."""
    shown = observation_space(track, prompts=1, flat=flat).spaces
    return {
        ACTION: PolicyFeature(FeatureType.ACTION, action_space().shape),
        **{
            key: PolicyFeature(FEATURE_TYPES.get(key, FeatureType.STATE), space.shape or ())
            for key, space in shown.items()
        },
    }


@EnvConfig.register_subclass("kitchen_prefs")
@dataclass
class KitchenPrefsEnv(EnvConfig):
    """Sessions of one split.

    Attributes:
        task: The split.
        track: "standard", "privileged" (adds the preference's label) or "language" (gives the
            preference in words as the task).
        flat: Whether a set is flat, (936,), as in the data sets. A checkpoint that was trained on
            data of the first format and normalises the set needs rows, (72, 13).

    Raises:
        ValueError: If the split or the track is unknown.
    """

    task: str = "seen"
    fps: int = DishwasherLoading.metadata["render_fps"]
    track: str = "standard"
    flat: bool = True
    features: dict[str, PolicyFeature] = field(default_factory=dict)
    features_map: dict[str, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        get_split(self.task)
        if self.track not in TRACKS:
            raise ValueError(f"There is no track {self.track!r}. {suggest(self.track, TRACKS)}")
        self.features = features_of(self.track, self.flat)
        self.features_map = {key: FEATURES_MAP[key] for key in self.features}

    @property
    def gym_kwargs(self) -> dict[str, Any]:
        """The environment's arguments."""
        # Flat already in the observation, not by a processor: LeRobot records observations as the
        # environment gives them, and checks their shapes against the features.
        shown = {"track": self.track, "flat": self.flat, "render_mode": "rgb_array"}
        return {"split": self.task, **shown}

    def create_envs(
        self, n_envs: int, use_async_envs: bool = False
    ) -> dict[str, dict[int, gymnasium.vector.VectorEnv]]:
        """A batch of environments for each preference of the split; its label is the task's id.

        They rest once their episode has ended. `use_async_envs`, LeRobot's default, is not
        followed: all run in this process, where a decision takes a tenth of a millisecond, while
        starting a process for each takes seconds and 750 MB.
        """
        labels = get_split(self.task).tasks
        return {self.type: {label: self._batch(label, n_envs) for label in labels}}

    def _batch(self, label: int, n_envs: int) -> gymnasium.vector.VectorEnv:
        one = freeze_after_episode_end(lambda: DishwasherLoading(**self.gym_kwargs, task_id=label))
        mode = gymnasium.vector.AutoresetMode.SAME_STEP
        return gymnasium.vector.SyncVectorEnv([one] * n_envs, autoreset_mode=mode)
