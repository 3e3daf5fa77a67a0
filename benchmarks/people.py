"""The second tier beside the first: decisions a second, and making a data set with certificates."""

import shutil
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path

from benchmarks.measuring import Result, rates
from kitchen_prefs.datasets.names import content_of
from kitchen_prefs.datasets.writing import write_dataset
from kitchen_prefs.envs.environment import DishwasherLoading
from kitchen_prefs.envs.kitchen_env import KitchenEnv
from kitchen_prefs.envs.people_environment import DishwasherPeople
from kitchen_prefs.people.sessions import make_people_session

SESSIONS = range(10)


def people_beside_preferences() -> Iterator[Result]:
    steps = rates(_steps(DishwasherPeople("people_train")), _steps(DishwasherLoading("train")))
    yield Result(
        "people: step, reset included", steps[0], "decisions/s", "the first tier", steps[1]
    )
    made = rates(_making("dishwasher-people_train-u35-v2"), _making("dishwasher-val-v1"))
    yield Result("people: making a data set", made[0], "episodes/s", "the first tier", made[1])


def _steps(environment: KitchenEnv) -> Callable[[], int]:
    """Repeats what the expert does in some sessions."""
    actions = {}
    for session in SESSIONS:
        environment.reset(options={"session": session})
        actions[session] = []
        while not environment.simulator.terminated:
            actions[session].append(environment.simulator.expert_action())
            environment.step(actions[session][-1])

    def steps() -> int:
        for session, of_session in actions.items():
            environment.reset(options={"session": session})
            for action in of_session:
                environment.step(action)
        return sum(map(len, actions.values()))

    return steps


def _making(name: str) -> Callable[[], int]:
    """Makes a data set, of sessions that are drawn anew."""
    content = content_of(name)

    def make() -> int:
        make_people_session.cache_clear()
        folder = Path(tempfile.mkdtemp())
        write_dataset(content, folder / name)
        shutil.rmtree(folder)
        return len(content.sessions)

    return make
