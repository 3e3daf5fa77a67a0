"""A policy in scenes, from the first look to the last decision."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from kitchen_prefs.evaluation.rollouts import Policy
from kitchen_prefs.metrics import Interval, mean_of_groups
from kitchen_prefs_robot.demonstrations.preferences import human_preference
from kitchen_prefs_robot.execution.conditions import Conditions
from kitchen_prefs_robot.execution.episode import RobotEpisode
from kitchen_prefs_robot.execution.outcomes import (
    EpisodeOutcome,
    outcome_of,
    outcome_without_prompt,
)
from kitchen_prefs_robot.execution.prompts import ATTEMPTS, NotUnderstoodError, Prompt, prompt_for
from kitchen_prefs_robot.execution.watching import NOBODY, Watcher
from kitchen_prefs_robot.task.rollouts import TASK, policy_observation
from kitchen_prefs_robot.task.rows import chosen_decision
from kitchen_prefs_robot.task.summaries import summarise

VARIATIONS = {
    "all real": Conditions(),
    "perfect perception": Conditions(perception="truth"),
    "perfect grasps": Conditions(grasps="truth"),
    "perfect perception and grasps": Conditions(perception="truth", grasps="truth"),
    "alike colours, lamp 20 %": Conditions(colours="alike", lamp=0.2),
    "lamp 40 %": Conditions(lamp=0.4),
    "depth noise x 3": Conditions(depth_noise=3.0),
    "cameras 5 mm off": Conditions(camera_error=0.005),
    "10 % of grasps led astray": Conditions(grasp_failures=0.1),
    "30 % of grasps led astray": Conditions(grasp_failures=0.3),
}


@dataclass(frozen=True)
class Trial:
    """A scene and a preference."""

    scene: int
    preference: int


def run_trial(
    policy: Policy,
    trial: Trial,
    conditions: Conditions,
    prompt: Prompt | None = None,
    watcher: Watcher = NOBODY,
) -> EpisodeOutcome:
    """Let a policy load a scene as a demonstration shows.

    Args:
        policy: The policy, as `kitchen_prefs.evaluation.policy_loading.load_policy` loads it.
        trial: The scene, and the preference that is demonstrated.
        conditions: What is left to the robot.
        prompt: The demonstration; one in another scene by default.
        watcher: Is told what happens.

    Returns:
        The outcome; where no demonstration is understood, nothing is done.
    """
    wanted = human_preference(trial.preference)
    if prompt is None:
        try:
            prompt = prompt_for(trial.scene, trial.preference, conditions)
        except NotUnderstoodError:
            return outcome_without_prompt(len(wanted.categories), shown=ATTEMPTS)
    with RobotEpisode(trial.scene, wanted, conditions, watcher.frame) as episode:
        policy.reset()
        while not (episode.terminated or episode.truncated):
            watcher.look(episode)
            decision = chosen_decision(
                episode.state, episode.rows, act(policy, episode, prompt.rows)
            )
            watcher.decide(episode, decision)
            episode.decide(decision)
        watcher.look(episode)
        return outcome_of(episode, prompt.shown, prompt.misread)


def act(policy: Policy, episode: RobotEpisode, prompt: np.ndarray) -> Sequence[float]:
    """The policy's next action, a pose (7,)."""
    return policy.act([observe_episode(episode, prompt)], [TASK])[0].tolist()


def observe_episode(episode: RobotEpisode, prompt: np.ndarray) -> dict[str, np.ndarray]:
    """What a policy observes before the next decision, without the cameras' pictures."""
    summary, agent = summarise(episode.state, len(episode.steps))
    observation = policy_observation(episode.rows, prompt)
    return observation | {"environment_state": summary, "agent_pos": agent}


def trials(scenes: Iterable[int], preferences: int) -> Iterator[Trial]:
    """Each scene with each preference."""
    for scene in scenes:
        for preference in range(preferences):
            yield Trial(scene, preference)


def mean_right(outcomes: Mapping[Trial, EpisodeOutcome]) -> Interval:
    """The mean share of dishes that are right, with the 95 % interval over scenes."""
    of_scene: dict[int, list[float]] = {}
    for trial, outcome in outcomes.items():
        of_scene.setdefault(trial.scene, []).append(outcome.right)
    return mean_of_groups(list(of_scene.values()))
