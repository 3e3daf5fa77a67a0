"""The ladder of yardsticks on the splits of the second tier, in the real kitchen."""

from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context

from tqdm import tqdm

from kitchen_prefs.envs.people_simulator import PeopleSimulator
from kitchen_prefs.metrics import Interval
from kitchen_prefs.metrics.people_episode import PeopleEpisode
from kitchen_prefs.metrics.people_intervals import HEADLINE, summarise_people
from kitchen_prefs.people.expert import PlanExpert
from kitchen_prefs.people.sessions import PeopleSession, make_people_session
from kitchen_prefs.people.splits import (
    PEOPLE_DATA_VERSION,
    PEOPLE_SPLITS,
    get_people_split,
)
from kitchen_prefs.people.users import LoadingPlan
from kitchen_prefs.people.yardsticks import YARDSTICKS, Shown, shown_in
from kitchen_prefs_experiments.markdown import interval_cell, markdown_table

EVALUATED = tuple(PEOPLE_SPLITS)[1:]
EXPERT = "expert"
FLOOR, CEILING = "promptless", "bayes"
COLUMNS = (HEADLINE, "Where", "Turn", "Style", "Care")
NO_ACTION = (0.0,) * 7  # the yardsticks choose instances; no metric reads the action

Ladder = dict[str, dict[str, dict[str, Interval]]]  # split, yardstick, metric


def climb(sessions: int | None = None, salt: int = 0, splits: Sequence[str] = EVALUATED) -> Ladder:
    """Let every yardstick load the sessions of every split but that of training, on all cores.

    Args:
        sessions: The first so many of each split; None for all.
        salt: The session seed.
        splits: Which splits.
    """
    found: Ladder = {}
    context = get_context("spawn")
    with ProcessPoolExecutor(mp_context=context) as pool:
        for split in splits:
            count = min(sessions or get_people_split(split).sessions, get_people_split(split).users)
            jobs = [(split, index, salt) for index in range(count)]
            loaded = list(tqdm(pool.map(load_all, jobs, chunksize=2), split, count, unit="session"))
            found[split] = {
                name: summarise_people([episodes[name] for episodes in loaded])
                for name in loaded[0]
            }
    return found


def load_all(job: tuple[str, int, int]) -> dict[str, PeopleEpisode]:
    """The episode of each yardstick, and of the expert, in one session."""
    session = make_people_session(*job)
    return {name: load(session, plan) for name, plan in plans_for(session)}


def plans_for(session: PeopleSession) -> Iterator[tuple[str, LoadingPlan]]:
    """How each yardstick would load a session's dishes, and how its user does."""
    shown = what_is_shown(session)
    for name, yardstick in YARDSTICKS.items():
        yield name, yardstick(shown, session.dishes)
    yield EXPERT, session.expert.plan


def what_is_shown(session: PeopleSession) -> Shown:
    """What readers see of the user whose evening it is."""
    return shown_in(
        [
            (one.trajectory.kitchen, one.trajectory.decisions, one.evidence)
            for one in session.own_prompts
        ]
    )


def load(session: PeopleSession, plan: LoadingPlan) -> PeopleEpisode:
    """The episode of a session in which its dishes are loaded by a plan."""
    simulator = PeopleSimulator(session)
    expert = PlanExpert(simulator.kitchen, plan)
    while not (simulator.terminated or simulator.truncated):
        simulator.decide(expert.choose(), NO_ACTION)
    return simulator.episode()


def references_of(ladder: Ladder) -> dict[str, dict[str, float]]:
    """The floor and the ceiling of each split, between which H is rescaled."""
    return {
        split: {
            "floor": round(of_split[FLOOR][HEADLINE].mean, 4),
            "ceiling": round(of_split[CEILING][HEADLINE].mean, 4),
        }
        for split, of_split in ladder.items()
    }


def rescaled(of_split: dict[str, dict[str, Interval]], name: str) -> float:
    """H between the split's floor, 0, and its ceiling, 1."""
    floor, ceiling, own = (of_split[one][HEADLINE].mean for one in (FLOOR, CEILING, name))
    return (own - floor) / (ceiling - floor)


HEAD = """# The ladder of the second tier

What simple readers of a user's demonstrations reach, from no prompt to the exact reader of the
grammar and the user herself, {sessions} of data version {version}. Means, with 95 %
bootstrap intervals over users; `rescaled` is H between `promptless`, 0, and `bayes`, 1; Care counts
dishes a session that are washed by hand and were loaded.

```
uv run kitchen-prefs people ladder --out=docs/results/people
```
"""


def ladder_page(ladder: Ladder, sessions: str) -> str:
    """The ladder in Markdown, a table a split.

    Args:
        ladder: The ladder.
        sessions: Which sessions it is of, in words.
    """
    parts = [HEAD.format(sessions=sessions, version=PEOPLE_DATA_VERSION)]
    for split, of_split in ladder.items():
        rows = [
            [
                f"`{name}`",
                f"{rescaled(of_split, name):.2f}",
                *(interval_cell(metrics[column]) for column in COLUMNS),
            ]
            for name, metrics in of_split.items()
        ]
        table = markdown_table(["yardstick", "rescaled", *COLUMNS], rows)
        parts.append(f"## {split}: {get_people_split(split).purpose}\n\n{table}\n")
    return "\n".join(parts)
