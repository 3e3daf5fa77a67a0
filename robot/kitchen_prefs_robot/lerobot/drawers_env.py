"""`--env.type=kitchen_prefs_drawers`: the drawers for `lerobot-eval`, a task a preference."""

from dataclasses import dataclass, field
from typing import Any

import gymnasium
from lerobot.configs import FeatureType, PolicyFeature
from lerobot.envs.configs import EnvConfig
from lerobot.envs.utils import freeze_after_episode_end
from lerobot.utils.constants import OBS_IMAGES

from kitchen_prefs.envs.lerobot_env import FEATURES_MAP, features_of
from kitchen_prefs.utils.suggestions import suggest
from kitchen_prefs_robot.demonstrations.preferences import HUMAN_PREFERENCES
from kitchen_prefs_robot.execution.environment import Drawers
from kitchen_prefs_robot.execution.trials import VARIATIONS
from kitchen_prefs_robot.scene.views import CAMERAS, PICTURE_SIZE


@EnvConfig.register_subclass("kitchen_prefs_drawers")
@dataclass
class DrawersEnv(EnvConfig):
    """Scenes with four dishes and two drawers.

    Attributes:
        task: What is left to the robot, a row of `kitchen-prefs robot table`.

    Raises:
        ValueError: If there is no such variation.
    """

    task: str = "all real"
    fps: int = Drawers.metadata["render_fps"]
    features: dict[str, PolicyFeature] = field(default_factory=dict)
    features_map: dict[str, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if self.task not in VARIATIONS:
            raise ValueError(
                f"There is no variation {self.task!r}. {suggest(self.task, VARIATIONS)}"
            )
        width, height = PICTURE_SIZE
        picture = PolicyFeature(FeatureType.VISUAL, (height, width, 3))
        self.features = features_of("standard") | {f"pixels/{name}": picture for name in CAMERAS}
        images = {f"pixels/{name}": f"{OBS_IMAGES}.{name}" for name in CAMERAS}
        shown = FEATURES_MAP | images
        self.features_map = {key: shown[key] for key in self.features}

    @property
    def gym_kwargs(self) -> dict[str, Any]:
        """The environment's arguments."""
        return {"conditions": VARIATIONS[self.task], "flat": True, "render_mode": "rgb_array"}

    def create_envs(
        self, n_envs: int, use_async_envs: bool = False
    ) -> dict[str, dict[int, gymnasium.vector.VectorEnv]]:
        """A batch of environments for each preference, in this process; its number is the task."""
        labels = range(len(HUMAN_PREFERENCES))
        return {self.type: {label: self._batch(label, n_envs) for label in labels}}

    def _batch(self, label: int, n_envs: int) -> gymnasium.vector.VectorEnv:
        one = freeze_after_episode_end(lambda: Drawers(**self.gym_kwargs, task_id=label))
        mode = gymnasium.vector.AutoresetMode.SAME_STEP
        return gymnasium.vector.SyncVectorEnv([one] * n_envs, autoreset_mode=mode)
