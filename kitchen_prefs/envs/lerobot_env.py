"""LeRobot's view of the environment: `--env.type=kitchen_prefs --env.task=<split>`."""

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from typing import Any

import gymnasium
from gymnasium.spaces import Dict
from lerobot.configs import FeatureType, PolicyFeature
from lerobot.envs.configs import EnvConfig
from lerobot.envs.utils import freeze_after_episode_end
from lerobot.utils.constants import ACTION, OBS_ENV_STATE, OBS_STATE

from kitchen_prefs.envs.environment import TRACKS, DishwasherLoading
from kitchen_prefs.envs.kitchen_env import KitchenEnv
from kitchen_prefs.envs.people_environment import DishwasherPeople, people_observation_space
from kitchen_prefs.envs.spaces import action_space, observation_space
from kitchen_prefs.people.splits import PEOPLE_SPLITS
from kitchen_prefs.splits import SPLITS
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
    return _features_of_space(observation_space(track, prompts=1, flat=flat))


def people_features_of(split: str, flat: bool = True) -> dict[str, PolicyFeature]:
    """The raw keys of the second tier's environment on a split, as LeRobot's features."""
    return _features_of_space(people_observation_space(PEOPLE_SPLITS[split].prompts, flat))


def _features_of_space(shown: Dict) -> dict[str, PolicyFeature]:
    return {
        ACTION: PolicyFeature(FeatureType.ACTION, action_space().shape),
        **{
            key: PolicyFeature(FEATURE_TYPES.get(key, FeatureType.STATE), space.shape or ())
            for key, space in shown.spaces.items()
        },
    }


@EnvConfig.register_subclass("kitchen_prefs")
@dataclass
class KitchenPrefsEnv(EnvConfig):
    """Sessions of one split, of either tier.

    Attributes:
        task: The split.
        track: "standard", "privileged" (adds the preference's label) or "language" (gives the
            preference in words as the task). The second tier has the first of them alone.
        flat: Whether a set is flat, (936,) or (1596,), as in the data sets. A checkpoint that was
            trained on data of the first format and normalises the set needs rows, (72, 13).

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
        splits = (*SPLITS, *PEOPLE_SPLITS)
        if self.task not in splits:
            raise ValueError(f"There is no split {self.task!r}. {suggest(self.task, splits)}")
        if self.track not in TRACKS:
            raise ValueError(f"There is no track {self.track!r}. {suggest(self.track, TRACKS)}")
        if self._of_people and self.track != "standard":
            raise ValueError(
                f"The split {self.task!r} is of the second tier, which has no track "
                f"{self.track!r} yet; leave --env.track out."
            )
        if self._of_people:
            self.features = people_features_of(self.task, self.flat)
        else:
            self.features = features_of(self.track, self.flat)
        self.features_map = {key: FEATURES_MAP[key] for key in self.features}

    @property
    def gym_kwargs(self) -> dict[str, Any]:
        """The environment's arguments."""
        # Flat already in the observation, not by a processor: LeRobot records observations as the
        # environment gives them, and checks their shapes against the features.
        shown = {"split": self.task, "flat": self.flat, "render_mode": "rgb_array"}
        return shown if self._of_people else {**shown, "track": self.track}

    @property
    def _of_people(self) -> bool:
        """Whether the split is of the second tier."""
        return self.task in PEOPLE_SPLITS

    def create_envs(
        self, n_envs: int, use_async_envs: bool = False
    ) -> dict[str, dict[int, gymnasium.vector.VectorEnv]]:
        """A batch of environments for each preference of the split; its label is the task's id.

        A split of the second tier, whose users are all different, has one task, 0.

        They rest once their episode has ended. `use_async_envs`, LeRobot's default, is not
        followed: all run in this process, where a decision takes a tenth of a millisecond, while
        starting a process for each takes seconds and 750 MB.
        """
        if self._of_people:
            return {
                self.type: {0: self._batch(partial(DishwasherPeople, **self.gym_kwargs), n_envs)}
            }
        tasks = {
            label: self._batch(partial(DishwasherLoading, **self.gym_kwargs, task_id=label), n_envs)
            for label in SPLITS[self.task].tasks
        }
        return {self.type: tasks}

    def _batch(self, make: Callable[[], KitchenEnv], n_envs: int) -> gymnasium.vector.VectorEnv:
        one = freeze_after_episode_end(make)
        mode = gymnasium.vector.AutoresetMode.SAME_STEP
        return gymnasium.vector.SyncVectorEnv([one] * n_envs, autoreset_mode=mode)
