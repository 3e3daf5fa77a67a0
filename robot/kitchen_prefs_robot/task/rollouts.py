"""Rolls a policy of the kitchen out on sessions of the drawers, in batches."""

from collections.abc import Sequence
from itertools import batched

import numpy as np
from tqdm import tqdm

from kitchen_prefs import instances
from kitchen_prefs.evaluation.rollouts import BATCH_SIZE, Policy
from kitchen_prefs.metrics import Episode
from kitchen_prefs_robot.task.demonstrations import demonstrate
from kitchen_prefs_robot.task.expert import choose
from kitchen_prefs_robot.task.metrics import episode_of
from kitchen_prefs_robot.task.rows import chosen_decision, observe
from kitchen_prefs_robot.task.sessions import DrawersSession, prompt_session
from kitchen_prefs_robot.task.simulator import PERFECT, DrawersSimulator, Perception

TASK = "Load the drawers as the demonstration shows."


def roll_out(
    policy: Policy,
    sessions: Sequence[DrawersSession],
    perception: Perception = PERFECT,
    *,
    opposite: bool = False,
    name: str = "drawers",
) -> list[Episode]:
    """Roll a policy out on sessions.

    Args:
        policy: The policy, as `kitchen_prefs.evaluation.policy_loading.load_policy` loads it.
        sessions: The sessions.
        perception: How situations are seen. A prompt is seen with the same noise, but its
            categories are right: whoever shows it corrects them.
        opposite: Whether the prompts show the opposite preference.
        name: What the progress bar shows.

    Returns:
        One episode a session.
    """
    episodes: list[Episode] = []
    with tqdm(total=len(sessions), desc=name, unit="episode") as bar:
        for batch in batched(sessions, BATCH_SIZE):
            simulators = [DrawersSimulator(session, perception) for session in batch]
            prompts = [_prompt(session, perception.noise, opposite) for session in batch]
            _roll_out_batch(policy, simulators, prompts)
            episodes += map(episode_of, simulators)
            bar.update(len(batch))
    return episodes


def roll_out_expert(sessions: Sequence[DrawersSession], perception: Perception) -> list[Episode]:
    """Roll the expert out on what it sees: what a perfect policy would do with that perception."""
    simulators = [DrawersSimulator(session, perception) for session in sessions]
    for simulator in simulators:
        while not simulator.terminated:
            simulator.decide(choose(simulator.seen, simulator.session.preference))
    return [episode_of(simulator) for simulator in simulators]


def policy_observation(rows: np.ndarray, prompt: np.ndarray) -> dict[str, np.ndarray]:
    """An observation as a policy of the kitchen takes it, without the flat summaries.

    Args:
        rows: The instance set, (N, 13).
        prompt: The prompt, (1664, 14).
    """
    return {"instances": instances.pack(rows), "prompt": prompt}


def _prompt(session: DrawersSession, noise: float, opposite: bool) -> np.ndarray:
    return demonstrate(prompt_session(session, opposite), Perception(noise)).prompt


def _roll_out_batch(
    policy: Policy, simulators: Sequence[DrawersSimulator], prompts: Sequence[np.ndarray]
) -> None:
    """Decide until all episodes have ended; one that has ended is no longer changed."""
    policy.reset()
    running = True
    while running:
        seen = [observe(simulator.seen, len(simulator.decisions)) for simulator in simulators]
        observations = [policy_observation(*pair) for pair in zip(seen, prompts, strict=True)]
        actions = policy.act(observations, [TASK] * len(simulators))  # (B, 7)
        running = False
        for simulator, rows, action in zip(simulators, seen, actions, strict=True):
            if not (simulator.terminated or simulator.truncated):
                simulator.decide(chosen_decision(simulator.seen, rows, action))
            running |= not (simulator.terminated or simulator.truncated)
