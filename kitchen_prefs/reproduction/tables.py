"""The tables of the paper: what is evaluated on what, and what the paper says.

The paper gives most of its figures as curves; only numbers that stand in its text are repeated.
"""

import json
from collections.abc import Mapping
from dataclasses import dataclass, field

from kitchen_prefs.reproduction.policies import Committed, Policy, Rule, Training
from kitchen_prefs.splits import DATA_VERSION, TEST_SPLITS, get_split, suggest


@dataclass(frozen=True)
class Table:
    """A table of the paper.

    Its groups are the sets of episodes that a mean is taken over: the splits and, where `by_count`
    holds, the sessions of all of them by their number of dishes per rack.

    Attributes:
        title: Its heading.
        paper: What the paper says.
        axis: What stands along the picture's horizontal axis.
        rows: The policies, each with what it is called; in a table of several groups "symbolic" is
            among them, of which the others reach a share.
        splits: The splits they are evaluated on.
        metrics: The metrics that are shown; the first is that of the picture and of the paper.
        paper_values: The paper's figures: what they are called -> group -> value or, in a table of
            one group, -> row -> value.
        prompt_use: The splits whose sessions are played with another preference's prompt, too.
        by_count: Whether there is a group for each number of dishes per rack.
    """

    title: str
    paper: str
    axis: str
    rows: Mapping[str, Policy]
    splits: tuple[str, ...]
    metrics: tuple[str, ...]
    paper_values: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    prompt_use: tuple[str, ...] = ()
    by_count: bool = False

    @property
    def groups(self) -> tuple[str, ...]:
        """The names of the groups, in the order in which they are shown."""
        return (*map(str, self.counts), *self.splits)

    @property
    def counts(self) -> list[int]:
        """The numbers of dishes per rack that have a group."""
        counts = {count for split in self.splits for count in get_split(split).counts}
        return sorted(counts) if self.by_count else []

    @property
    def policies(self) -> list[Policy]:
        """The policies of the rows, each once."""
        return list(dict.fromkeys(self.rows.values()))

    @property
    def trains(self) -> bool:
        """Whether something has to be trained for it."""
        return any(isinstance(policy, Training) for policy in self.policies)


def get_table(name: str) -> Table:
    """The table with a given name.

    Raises:
        ValueError: If there is none; the message suggests the nearest.
    """
    if name not in TABLES:
        raise ValueError(f"There is no table {name!r}. {suggest(name, TABLES)}")
    return TABLES[name]


def _preferences(number: int) -> Training:
    return Training(f"p{number}", f"dishwasher-train-p{number}-d80-v{DATA_VERSION}")


def _demonstrations(number: int) -> Training:
    return Training(f"d{number}", f"dishwasher-train-p7-d{number}-v{DATA_VERSION}")


def _hidden(*attributes: str) -> Training:
    override = f"--policy.hidden={json.dumps(attributes)}"  # LeRobot reads lists as JSON
    return Training(f"hidden-{'-'.join(attributes)}", overrides=(override,))


def _encoding(attribute: str, encoding: str) -> Training:
    override = f"--policy.{attribute}_encoding={encoding}"
    return Training(f"{attribute}-{encoding}", overrides=(override,))


BASE = Training("base")  # all of the training data, everything as in the recipe
TTP = {"TTP, ttp_paper": Committed("ttp_paper"), "TTP, ttp_plus": Committed("ttp_plus")}
RULES = ("random", "majority", "nearest", "symbolic", "expert")

TABLES = {
    "main": Table(
        title="The test splits",
        paper=(
            "TTP packs .62 of what the expert packs on seen preferences, .54 on unseen ones and "
            ".34 on unseen numbers of dishes. Its graph network, which is told the preference, "
            "reaches .34 on seen preferences by imitation and .017 ± .002 by reinforcement; random "
            "decisions do not solve the task at all."
        ),
        axis="test split",
        rows=TTP | {rule: Rule(rule) for rule in RULES},
        splits=TEST_SPLITS,
        metrics=("PE", "Score", "ED_c", "ED", "TE", "Success", "Prompt use"),
        paper_values={
            "TTP in the paper": {"seen": 0.62, "unseen_preferences": 0.54, "unseen_counts": 0.34},
            "GNN-IL in the paper": {"seen": 0.34},
        },
        prompt_use=("seen", "unseen_preferences"),
    ),
    "counts": Table(
        title="The number of dishes",
        paper=(
            "Trained on 6 and 7 dishes per rack, TTP does well on 5 to 7 and worse the further "
            "away: .62 on the numbers that it has seen, .34 on the others. With 3 or 4 dishes it "
            "closes the dishwasher early. The curve's points have no numbers in the text."
        ),
        axis="dishes per rack, and the means of the two splits that they come from",
        rows=TTP | {"symbolic": Rule("symbolic")},
        splits=("seen", "unseen_counts"),
        metrics=("PE",),
        paper_values={"TTP in the paper": {"seen": 0.62, "unseen_counts": 0.34}},
        by_count=True,
    ),
    "preferences": Table(
        title="The number of training preferences",
        paper=(
            "On unseen preferences PE rises up to four training preferences and is about the same "
            "from four to seven (a curve without numbers)."
        ),
        axis="training preferences, 80 demonstrations each",
        rows={str(number): _preferences(number) for number in range(1, 7)} | {"7": BASE},
        splits=("unseen_preferences",),
        metrics=("PE", "Score"),
    ),
    "demonstrations": Table(
        title="The number of demonstrations",
        paper=(
            "PE on seen preferences rises with the number of demonstrations up to the last (a "
            "curve without numbers)."
        ),
        axis="demonstrations of each of the seven training preferences",
        rows={str(number): _demonstrations(number) for number in (10, 20, 40, 60)} | {"80": BASE},
        splits=("seen",),
        metrics=("PE", "Score"),
    ),
    "prompts": Table(
        title="The number of prompts",
        paper="The paper proposes several prompts against one that shows too little; no figures.",
        axis="test split",
        rows={
            "TTP, ttp_plus, 1 prompt": Committed("ttp_plus"),
            "TTP, ttp_plus, 2 prompts": Committed("ttp_plus", prompts=2),
            "TTP, ttp_plus, 4 prompts": Committed("ttp_plus", prompts=4),
            "symbolic": Rule("symbolic"),
            "symbolic, 2 prompts": Rule("symbolic", prompts=2),
            "symbolic, 4 prompts": Rule("symbolic", prompts=4),
        },
        splits=("seen", "unseen_preferences"),
        metrics=("PE", "Score", "ED_c"),
    ),
    "attributes": Table(
        title="What is seen of an instance",
        paper=(
            "Every attribute helps: pose most, then category, then time. With all three PE is "
            ".606, without the pose at most .142."
        ),
        axis="attributes that the policy sees",
        rows={
            "nothing": _hidden("pose", "category", "time"),
            "time": _hidden("pose", "category"),
            "category": _hidden("pose", "time"),
            "category, time": _hidden("pose"),
            "pose": _hidden("category", "time"),
            "pose, time": _hidden("category"),
            "pose, category": _hidden("time"),
            "pose, category, time": BASE,
        },
        splits=("seen",),
        metrics=("PE", "Score"),
        paper_values={
            "TTP in the paper": {
                "nothing": 0.0,
                "time": 0.0,
                "category": 0.027,
                "category, time": 0.142,
                "pose": 0.411,
                "pose, time": 0.419,
                "pose, category": 0.517,
                "pose, category, time": 0.606,
            }
        },
    ),
    "batch_size": Table(
        title="The batch size",
        paper="Category accuracy comes close to 1 (curves without numbers, one for a batch size).",
        axis="decisions in a batch",
        rows={
            "8": Training("batch-8", batch_size=8),
            "16": Training("batch-16", batch_size=16),
            "32": BASE,
            "64": Training("batch-64", batch_size=64),
        },
        splits=("val",),
        metrics=("Category accuracy", "PE"),
    ),
    "encoders": Table(
        title="The encoders of the attributes",
        paper=(
            "Time: a table and Fourier features do equally well, none slightly worse. Category: "
            "Fourier features of the extents do better than labels, labels better than none. Pose: "
            "Fourier features do better than the seven numbers (curves without numbers)."
        ),
        axis="attribute and its encoder",
        rows={
            "time: table": _encoding("time", "table"),
            "time: fourier": BASE,
            "time: none": _hidden("time"),
            "category: fourier": BASE,
            "category: label": _encoding("extents", "label"),
            "category: linear": _encoding("extents", "linear"),
            "category: none": _hidden("category"),
            "pose: fourier": BASE,
            "pose: linear": _encoding("pose", "linear"),
            "pose: none": _hidden("pose"),
        },
        splits=("val",),
        metrics=("Category accuracy", "PE"),
    ),
}
