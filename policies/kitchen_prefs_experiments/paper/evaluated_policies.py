"""The policies that the tables evaluate: committed checkpoints, rules, trainings, fine-tunings."""

import json
from dataclasses import dataclass
from pathlib import Path

from kitchen_prefs.splits import DATA_VERSION, HELD_OUT_USERS
from kitchen_prefs_experiments.recipes import recipe_file

RECIPE = "ttp_quick"  # what most trainings start from: it learns from nothing in minutes

# A network that has learned already needs small steps and no warm-up, and one preference as it is.
FINE_TUNING = (
    "--policy.relabel=false",
    "--policy.rounds=1",
    "--optimizer.lr=1.0e-4",  # a fifth of the recipe's
    "--scheduler.num_warmup_steps=0",
)


@dataclass(frozen=True)
class Committed:
    """A checkpoint that the repository holds, `policies/checkpoints/<name>`.

    Attributes:
        name: Names the checkpoint.
        prompts: How many demonstrations prompt an episode.
    """

    name: str
    prompts: int = 1

    def find(self) -> Path:
        """Its folder, beside the recipes.

        Raises:
            ValueError: If it is not there.
        """
        folder = recipe_file(RECIPE).parents[1] / "checkpoints" / self.name
        if not folder.is_dir():
            raise ValueError(
                f"There is no checkpoint {self.name!r} yet; train its recipe and put the best "
                f"checkpoint's pretrained_model at {folder}."
            )
        return folder


@dataclass(frozen=True)
class Rule:
    """A rule of the policy type "rules", which needs no training.

    Attributes:
        name: Names the rule.
        prompts: How many demonstrations prompt an episode.
    """

    name: str
    prompts: int = 1


@dataclass(frozen=True)
class Training:
    """A training of a recipe with some settings overridden.

    Attributes:
        name: Names the run's folder, so trainings with one name are one training.
        dataset: What it is trained on.
        batch_size: How many decisions a step sees.
        overrides: Further options of lerobot-train.
        preference: The label of the preference whose sessions alone it is measured on; None for
            all.
        recipe: The recipe.
    """

    name: str
    dataset: str = f"dishwasher-train-v{DATA_VERSION}"
    batch_size: int = 32  # that of most recipes
    overrides: tuple[str, ...] = ()
    preference: int | None = None
    recipe: str = RECIPE

    def steps(self, budget: int) -> int:
        """How many steps see `budget` decisions.

        Raises:
            ValueError: If it is not one step.
        """
        if budget < self.batch_size:
            raise ValueError(
                f"A budget of {budget} decisions is not one batch of {self.batch_size}; give a "
                "greater --budget."
            )
        return budget // self.batch_size

    def options(self, budget: int) -> list[str]:
        """What lerobot-train is told beside the recipe, for a budget of decisions."""
        return [
            f"--dataset.repo_id=kitchen_prefs/{self.dataset}",
            f"--batch_size={self.batch_size}",
            f"--steps={self.steps(budget)}",
            *self.overrides,
        ]


@dataclass(frozen=True)
class FineTuning:
    """A training that goes on with one demonstration of a held-out preference, once for each.

    Attributes:
        start: The training whose checkpoint they all begin from.
        steps: How many steps each takes.
    """

    start: Training
    steps: int

    @property
    def name(self) -> str:
        """Names the folder of the runs."""
        return f"fine-tuned-{self.steps}"

    @property
    def budget(self) -> int:
        """How many decisions each sees."""
        return self.steps * self.start.batch_size

    @property
    def trainings(self) -> tuple[Training, ...]:
        """One for each held-out preference, measured on the sessions of that one alone."""
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
    """The name of a policy with its number of prompts, if that is not one."""
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
    """Trained without seeing some attributes of instances."""
    override = f"--policy.hidden={json.dumps(attributes)}"  # LeRobot reads lists as JSON
    return Training(f"hidden-{'-'.join(attributes)}", overrides=(override,))


def encoding(attribute: str, encoder: str) -> Training:
    """Trained with another encoder of an attribute."""
    override = f"--policy.{attribute}_encoding={encoder}"
    return Training(f"{attribute}-{encoder}", overrides=(override,))


def history(decisions: int) -> Training:
    """Trained on one preference, with some earlier decisions in sight beside the present one."""
    return Training(
        f"history-{decisions}",
        f"dishwasher-train-p1-d80-v{DATA_VERSION}",
        overrides=(
            f"--policy.context_history={decisions}",
            # TTP demands both with a history; without one they keep the rows comparable.
            "--policy.relabel=false",
            "--policy.situation_time=true",
        ),
        preference=0,
    )


def act(decisions: int) -> Training:
    """LeRobot's ACT, which chooses several decisions at a time."""
    overrides = (f"--policy.chunk_size={decisions}", f"--policy.n_action_steps={decisions}")
    return Training(f"act-{decisions}", batch_size=64, overrides=overrides, recipe="act")
