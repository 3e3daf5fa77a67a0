"""Decisions a second of kitchen, environment and replays, beside CartPole's steps."""

from collections.abc import Iterator

import gymnasium
import numpy as np

from benchmarks.measuring import Result, rates
from kitchen_prefs.envs.environment import DishwasherLoading
from kitchen_prefs.envs.observations import Observer
from kitchen_prefs.metrics import Episode
from kitchen_prefs.simulation.kitchen import Kitchen
from kitchen_prefs.simulation.sessions import expert_trajectory, make_session
from kitchen_prefs_leaderboard.replay import replay, write_line

SESSIONS = range(0, 70, 5)


def kitchen_decisions() -> Iterator[Result]:
    sessions = [make_session("seen", i) for i in SESSIONS]
    decisions = [expert_trajectory(session).decisions for session in sessions]
    total = sum(map(len, decisions))
    environment = DishwasherLoading("seen")
    actions = {i: list(_actions(environment, i)) for i in SESSIONS}
    lines = [write_line(_rolled_out(environment, i, actions[i])) for i in SESSIONS]
    cartpole = gymnasium.make("CartPole-v1").unwrapped

    def kitchen_alone() -> int:
        for session, of_session in zip(sessions, decisions, strict=True):
            kitchen = Kitchen(session.dishes)
            for instance in of_session:
                kitchen.decide(instance)
        return total

    def kitchen_and_sets() -> int:
        for session, of_session in zip(sessions, decisions, strict=True):
            kitchen = Kitchen(session.dishes)
            observer = Observer(kitchen, np.random.default_rng(0), None)
            for instance in of_session:
                observer.observe()
                kitchen.decide(instance)
        return total

    def steps() -> int:
        for i in SESSIONS:
            environment.reset(options={"session": i})
            for action in actions[i]:
                environment.step(action)
        return total

    def replays() -> int:
        for line in lines:
            replay("seen", line, "a line")
        return total

    def cartpole_steps() -> int:
        cartpole.reset(seed=0)
        for _ in range(1000):
            cartpole.step(0)
            cartpole.steps_beyond_terminated = None
        return 1000

    names = (
        "kitchen: rules alone",
        "kitchen: rules and instance sets",
        "environment: step, reset included",
        "leaderboard: replay",
    )
    *found, yardstick = rates(kitchen_alone, kitchen_and_sets, steps, replays, cartpole_steps)
    for name, rate in zip(names, found, strict=True):
        yield Result(name, rate, "decisions/s", "CartPole-v1 steps", yardstick)


def _actions(environment: DishwasherLoading, session: int) -> Iterator[np.ndarray]:
    environment.reset(options={"session": session})
    terminated = False
    while not terminated:
        action = environment.simulator.expert_action()
        yield action
        terminated = environment.step(action)[2]


def _rolled_out(environment: DishwasherLoading, session: int, actions: list[np.ndarray]) -> Episode:
    environment.reset(options={"session": session})
    for action in actions:
        environment.step(action)
    return environment.episode()
