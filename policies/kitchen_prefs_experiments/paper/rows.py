"""The policies that stand in the tables' rows."""

import json

from kitchen_prefs.splits import DATA_VERSION
from kitchen_prefs_experiments.paper.evaluated_policies import Committed, Policy, Rule, Training

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
