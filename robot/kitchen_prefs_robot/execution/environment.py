"""The gymnasium environment: load two drawers as a person has shown, with the robot's arm."""

from typing import Any

import gymnasium
import numpy as np
from gymnasium.error import ResetNeeded
from gymnasium.spaces import Box, Dict

from kitchen_prefs.envs.spaces import action_space, observation_space
from kitchen_prefs_robot.demonstrations.preferences import HUMAN_PREFERENCES, human_preference
from kitchen_prefs_robot.execution.conditions import Conditions
from kitchen_prefs_robot.execution.episode import RobotEpisode
from kitchen_prefs_robot.execution.outcomes import outcome_of
from kitchen_prefs_robot.execution.prompts import prompt_for
from kitchen_prefs_robot.execution.step import Step
from kitchen_prefs_robot.execution.trials import observe_episode, trials
from kitchen_prefs_robot.scene import Pictures
from kitchen_prefs_robot.scene.views import CAMERAS, PICTURE_SIZE, VISITOR
from kitchen_prefs_robot.task.decisions import Place
from kitchen_prefs_robot.task.rollouts import TASK
from kitchen_prefs_robot.task.rows import chosen_decision

SCENES = range(50)  # on which settings of perception were chosen, too: `robot table` has others
MAX_EPISODE_STEPS = 24  # twice the expert's decisions


class Drawers(gymnasium.Env):
    """`kitchen_prefs/Drawers-v0`: four dishes, two drawers, one arm.

    One step is one decision, as in `kitchen_prefs/DishwasherLoading-v0`, and the arm executes it
    under contact physics before the next observation: open or close a drawer, pick a dish, drop it.

    | observation | shape | content |
    |---|---|---|
    | `instances` | (72, 13) | what the cameras found, as an instance set, zero-padded |
    | `environment_state` | (53,) | a flat summary of the set |
    | `agent_pos` | (11,) | openings (m), category in hand, decision index |
    | `prompt` | (1664, 14) | a person's demonstration in another scene |
    | `pixels` | 3 x (240, 320, 3) | the cameras' pictures before the decision, uint8 |

    An **action** is a pose, (7,), of which the nearest row is taken. The **reward** is 1 for a dish
    that is dropped into the drawer that the person chose, else 0.

    | info | content |
    |---|---|
    | `is_success` | whether all dishes are right and everything is closed |
    | `refusal` | why the rules did not allow the decision, else "" |
    | `result` | how the motion ended |

    Args:
        conditions: What is left to the robot, see `execution.conditions`; all of it by default.
        task_id: The number of the preference whose trials alone are simulated; None for all.
            Trials are scenes 0 to 49 with each preference.
        flat: Whether `instances` is flat, (936,), as LeRobot's data sets have it.
        render_mode: None or "rgb_array".

    Raises:
        ValueError: If there is no such preference.
    """

    metadata = {"render_modes": ["rgb_array"], "render_fps": 1}  # noqa: RUF012 (gymnasium's own form)
    _max_episode_steps = MAX_EPISODE_STEPS
    task = "kitchen_prefs_drawers"
    task_description = TASK

    def __init__(
        self,
        conditions: Conditions | None = None,
        task_id: int | None = None,
        flat: bool = False,
        render_mode: str | None = None,
    ) -> None:
        if task_id is not None:
            human_preference(task_id)  # that there is one
        self.render_mode = render_mode
        self.conditions = conditions or Conditions()
        known = trials(SCENES, len(HUMAN_PREFERENCES))
        self._trials = [trial for trial in known if task_id in (None, trial.preference)]
        self.action_space = action_space()
        shown = observation_space("standard", prompts=1, flat=flat).spaces
        width, height = PICTURE_SIZE
        picture = Box(0, 255, (height, width, 3), np.uint8)
        self.observation_space = Dict({**shown, "pixels": Dict(dict.fromkeys(CAMERAS, picture))})
        self._set_shape = self.observation_space["instances"].shape
        self._episode: RobotEpisode | None = None
        self._pixels: dict[str, np.ndarray] = {}

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[str, Any], dict[str, Any]]:
        """Start a trial: number `seed`, modulo their number, or one at random.

        Raises:
            ValueError: If the cameras see no dish, no table or no drawer.
        """
        super().reset(seed=seed)
        number = int(self.np_random.integers(len(self._trials))) if seed is None else seed
        trial = self._trials[number % len(self._trials)]
        self.close()
        self._prompt = prompt_for(trial.scene, trial.preference, self.conditions)
        wanted = human_preference(trial.preference)
        self._episode = RobotEpisode(trial.scene, wanted, self.conditions)
        if self._episode.blind:
            raise ValueError(self._episode.blind)
        return self._observe(), self._info("", None)

    def step(self, action: np.ndarray) -> tuple[dict[str, Any], float, bool, bool, dict[str, Any]]:
        """Execute one decision.

        Args:
            action: The chosen row's pose: position (m) and quaternion (wxyz), (7,).

        Returns:
            Observation, reward, terminated, truncated and info.

        Raises:
            ValueError: If the action has another shape or is not finite.
            ResetNeeded: If the episode has not begun or has ended.
        """
        episode = self.episode
        if episode.terminated or episode.truncated:
            raise ResetNeeded("The episode has ended; call reset() before the next step().")
        step = episode.decide(
            chosen_decision(episode.state, episode.rows, np.asarray(action).tolist())
        )
        earned = float(_is_right(episode, step))
        info = self._info(step.refusal, step.result)
        return self._observe(), earned, episode.terminated, episode.truncated, info

    def render(self) -> np.ndarray | None:
        """A picture of the whole robot, (360, 480, 3) uint8, if `render_mode` is "rgb_array"."""
        if self.render_mode is None:
            return None
        with Pictures(self.episode.world, 480, 360) as pictures:
            return pictures.colour(VISITOR)

    def close(self) -> None:
        """Release the cameras."""
        if self._episode is not None:
            self._episode.__exit__(None, None, None)
            self._episode = None

    @property
    def episode(self) -> RobotEpisode:
        """The present episode.

        Raises:
            ResetNeeded: If there is none.
        """
        if self._episode is None:
            raise ResetNeeded("The environment has no episode yet; call reset() first.")
        return self._episode

    def _observe(self) -> dict[str, Any]:
        episode = self.episode
        if episode.look.frames:
            frames = episode.look.frames
            self._pixels = {camera: frame.colour for camera, frame in frames.items()}
        width, height = PICTURE_SIZE
        blank = np.zeros((height, width, 3), np.uint8)  # where truth is given, nobody looks
        observed = observe_episode(episode, self._prompt.rows.copy())
        return observed | {
            "instances": observed["instances"].reshape(self._set_shape),
            "pixels": {camera: self._pixels.get(camera, blank) for camera in CAMERAS},
        }

    def _info(self, refusal: str, result: str | None) -> dict[str, Any]:
        outcome = outcome_of(self.episode)
        return {
            "is_success": outcome.right == 1.0 and outcome.closed,
            "refusal": refusal,
            "result": "" if result is None else str(result),
        }


def _is_right(episode: RobotEpisode, step: Step) -> bool:
    """Whether a decision dropped a dish into the drawer that the person chose."""
    if not isinstance(step.decision, Place) or step.dish is None or step.failed:
        return False
    category = episode.world.scene.dishes[step.dish].category
    return episode.preference.drawer_of[category] == step.decision.drawer
