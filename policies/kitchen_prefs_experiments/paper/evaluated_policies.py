"""The policies that the tables evaluate: committed checkpoints, rules, trainings, fine-tunings."""

import json
from dataclasses import dataclass
from pathlib import Path

from kitchen_prefs.splits import DATA_VERSION, HELD_OUT_USERS
from kitchen_prefs_experiments.checkpoints import find_checkpoint

RECIPE = "ttp_quick"  # the recipe of most trainings: it needs only minutes

# A trained network needs small steps and no warm-up; one preference is not relabelled.
FINE_TUNING = (
    "--policy.relabel=false",
    "--policy.rounds=1",
    "--optimizer.lr=1.0e-4",  # a fifth of the recipe's
    "--scheduler.num_warmup_steps=0",
)


@dataclass(frozen=True)
class Committed:
    """A checkpoint in the repository, `policies/checkpoints/<name>`.

    Attributes:
        name: The checkpoint's name.
        prompts: How many demonstrations prompt an episode.
    """

    name: str
    prompts: int = 1

    def find(self) -> Path:
        """Its folder.

        Raises:
            ValueError: If there is no such checkpoint, or if a file differs.
            OSError: If it is not installed and the hub does not have it.
        """
        return find_checkpoint(self.name)


@dataclass(frozen=True)
class Rule:
    """A rule of the policy type "rules", which needs no training.

    Attributes:
        name: The rule's name.
        prompts: How many demonstrations prompt an episode.
    """

    name: str
    prompts: int = 1


@dataclass(frozen=True)
class Training:
    """A training of a recipe with some settings overridden.

    Attributes:
        name: The name of the run's folder; trainings of the same name share a run.
        dataset: The name of the training data set.
        batch_size: The number of decisions in a step.
        overrides: Further options of lerobot-train.
        preference: The label of the only preference whose sessions are evaluated; None for all.
        recipe: The recipe.
    """

    name: str
    dataset: str = f"dishwasher-train-v{DATA_VERSION}"
    batch_size: int = 32  # that of most recipes
    overrides: tuple[str, ...] = ()
    preference: int | None = None
    recipe: str = RECIPE

    def steps(self, budget: int) -> int:
        """The number of training steps for a budget of decisions.

        Raises:
            ValueError: If the budget is smaller than one batch.
        """
        if budget < self.batch_size:
            raise ValueError(
                f"A budget of {budget} decisions is less than one batch of {self.batch_size}; give "
                "a greater --budget."
            )
        return budget // self.batch_size

    def options(self, budget: int) -> list[str]:
        """The options of lerobot-train that override the recipe, for a budget of decisions."""
        return [
            f"--dataset.repo_id=kitchen_prefs/{self.dataset}",
            f"--batch_size={self.batch_size}",
            f"--steps={self.steps(budget)}",
            *self.overrides,
        ]


@dataclass(frozen=True)
class FineTuning:
    """Continues a training on one demonstration of a held-out preference, once for each.

    Attributes:
        start: The training whose checkpoint is fine-tuned.
        steps: The number of steps of each fine-tuning.
    """

    start: Training
    steps: int

    @property
    def name(self) -> str:
        """The name of the folder of the runs."""
        return f"fine-tuned-{self.steps}"

    @property
    def budget(self) -> int:
        """The number of decisions in each fine-tuning."""
        return self.steps * self.start.batch_size

    @property
    def trainings(self) -> tuple[Training, ...]:
        """One for each held-out preference, evaluated on the sessions of that preference alone."""
        return tuple(
            Training(
                name=f"preference-{label + 1}",
                dataset=f"dishwasher-prompts-of{label + 1}-d1-v{DATA_VERSION}",
                batch_size=self.start.batch_size,
                overrides=FINE_TUNING,
                preference=label,
            )
            for label in HELD_OUT_USERS
        )


def numbered(name: str, prompts: int) -> str:
    """A policy's name, followed by its number of prompts if that is not 1."""
    return name if prompts == 1 else f"{name}-{prompts}-prompts"


Policy = Committed | Rule | Training | FineTuning

BASE = Training("base")  # all of the training data, everything as in the recipe
TTP: dict[str, Policy] = {f"TTP, {name}": Committed(name) for name in ("ttp_paper", "ttp_plus")}
QUICK = Committed("ttp_quick")
GNN_IL: dict[str, Policy] = {
    f"GNN-IL, {name} (privileged)": Committed(name)
    for name in ("gnn_paper", "gnn_paper_all", "gnn_tuned", "gnn_tuned_all")
}
GNN_RL: dict[str, Policy] = {
    "GNN-RL, 32,000 (open, privileged)": Committed("gnn_rl_32k"),
    "GNN-RL, 100,000 (open, privileged)": Committed("gnn_rl"),
    "GNN-RL, masked, 100,000 (open, privileged)": Committed("gnn_rl_masked"),
}
UNPROMPTED: dict[str, Policy] = {"ACT": Committed("act"), "diffusion": Committed("diffusion")}
RULES: dict[str, Policy] = {
    name: Rule(name) for name in ("random", "majority", "nearest", "symbolic", "expert")
}


def preferences(number: int) -> Training:
    """Trained on the first preferences alone, 80 demonstrations of each."""
    return Training(f"p{number}", f"dishwasher-train-p{number}-d80-v{DATA_VERSION}")


def demonstrations(number: int) -> Training:
    """Trained on all seven preferences, with fewer demonstrations of each."""
    return Training(f"d{number}", f"dishwasher-train-p7-d{number}-v{DATA_VERSION}")


def hidden(*attributes: str) -> Training:
    """Trained with some attributes of the instances hidden."""
    override = f"--policy.hidden={json.dumps(attributes)}"  # LeRobot reads lists as JSON
    return Training(f"hidden-{'-'.join(attributes)}", overrides=(override,))


def encoding(attribute: str, encoder: str) -> Training:
    """Trained with another encoder of an attribute."""
    override = f"--policy.{attribute}_encoding={encoder}"
    return Training(f"{attribute}-{encoder}", overrides=(override,))


def history(decisions: int) -> Training:
    """Trained on one preference, with some earlier decisions in the observation."""
    return Training(
        f"history-{decisions}",
        f"dishwasher-train-p1-d80-v{DATA_VERSION}",
        overrides=(
            f"--policy.context_history={decisions}",
            # TTP requires both with a history; without one they keep the rows comparable.
            "--policy.relabel=false",
            "--policy.situation_time=true",
        ),
        preference=0,
    )


def act(decisions: int) -> Training:
    """LeRobot's ACT, which chooses several decisions at a time."""
    overrides = (f"--policy.chunk_size={decisions}", f"--policy.n_action_steps={decisions}")
    return Training(f"act-{decisions}", batch_size=64, overrides=overrides, recipe="act")


def seeded(recipe: str, seed: int) -> Training:
    """A recipe as it stands, with another seed than LeRobot's 1000."""
    return Training(f"{recipe}-seed-{seed}", overrides=(f"--seed={seed}",), recipe=recipe)


def seeds(recipe: str) -> dict[str, Policy]:
    """Three trainings of a recipe: the committed one, and two more."""
    further = {str(seed): seeded(recipe, seed) for seed in (1, 2)}
    return {"1000, committed": Committed(recipe), **further}
