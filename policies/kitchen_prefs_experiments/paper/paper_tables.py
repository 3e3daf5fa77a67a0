"""The tables of the paper: their policies, splits and metrics, and the paper's values.

The paper gives most of its results as curves; only values from its text are repeated.
"""

from kitchen_prefs.splits import TEST_SPLITS
from kitchen_prefs.utils.suggestions import suggest
from kitchen_prefs_experiments.paper.evaluated_policies import (
    BASE,
    GNN_IL,
    GNN_RL,
    QUICK,
    RULES,
    TTP,
    UNPROMPTED,
    Committed,
    FineTuning,
    Rule,
    Training,
    act,
    demonstrations,
    encoding,
    hidden,
    history,
    preferences,
    seeds,
)
from kitchen_prefs_experiments.paper.table_types import Curves, Table

TABLE_METRICS = ("PE", "Score", "ED_c", "ED", "TE", "Success")

TABLES: dict[str, Table | Curves] = {  # in the order of the pages
    "main": Table(
        title="The test splits",
        paper=(
            "TTP has a PE of .62 on seen preferences, .54 on unseen ones and .34 on unseen numbers "
            "of dishes. The graph network, which is given the preference's label, has .34 on seen "
            "preferences by imitation and .017 ± .002 by reinforcement; random decisions have "
            "about 0."
        ),
        axis="test split",
        rows=TTP | RULES,
        splits=TEST_SPLITS,
        metrics=("PE", "Score", "ED_c", "ED", "TE", "Success", "Prompt use"),
        paper_values={
            "TTP in the paper": {"seen": 0.62, "unseen_preferences": 0.54, "unseen_counts": 0.34},
            "GNN-IL in the paper": {"seen": 0.34},
        },
        prompt_use=("seen", "unseen_preferences"),
    ),
    "gnn": Table(
        title="Graph networks with the preference's label",
        paper=(
            "GNN-IL, which is given the preference's label, has a PE of .34 on seen preferences, "
            "and no less on unseen ones, whose labels it is given, too (no figure)."
        ),
        axis="test split",
        rows=GNN_IL | {"TTP, ttp_quick": QUICK} | TTP | {"symbolic": RULES["symbolic"]},
        splits=TEST_SPLITS,
        metrics=TABLE_METRICS,
        paper_values={"GNN-IL in the paper": {"seen": 0.34}},
        note=(
            "The GNN rows are of the privileged track: the label is an input. There are twelve "
            "inputs for it, five of which `dishwasher-train-v1` never sets; the rows named `_all` "
            "are trained on `dishwasher-train-all-v1`, which shows all twelve preferences. The "
            "preferences of `many_preferences` have no input. `gnn_paper`, `gnn_paper_all` and "
            "`gnn_tuned` learned from 128,000 decisions, `gnn_tuned_all` continued `gnn_tuned` "
            "for 96,000, `ttp_quick` learned from 32,000. LeRobot clips gradients at a norm of 10 "
            "for `gnn_paper`, of which the paper says nothing; its rows are sampled, as the most "
            "probable row has half the PE on `val`. TTP, on the standard track, reads a prompt."
        ),
    ),
    "reinforcement": Table(
        title="Reinforcement learning",
        paper=(
            "GNN-RL, after 32,000 interactions of PPO, has a PE of .017 ± .002, random decisions "
            "about 0: sessions of more than thirty decisions are too long for it."
        ),
        axis="test split",
        rows=GNN_RL | {"random": RULES["random"], "symbolic": RULES["symbolic"]},
        splits=TEST_SPLITS,
        metrics=TABLE_METRICS,
        paper_values={"GNN-RL in the paper": {"seen": 0.017}},
        note=(
            "The GNN rows are of the open track, because they learn in the simulator, and they are "
            "given the label. An interaction is one decision here, a pick or a place; the paper "
            "does not say which split its figure is of. The masked PPO chose among feasible "
            "decisions in training. In evaluation no policy has a mask, and rows are sampled, as "
            "in training."
        ),
    ),
    "unprompted": Table(
        title="Imitation without a prompt",
        paper="LeRobot's policies are not in the paper.",
        axis="test split",
        rows=UNPROMPTED
        | {
            "TTP, ttp_quick": QUICK,
            **{name: RULES[name] for name in ("random", "majority", "symbolic")},
        },
        splits=TEST_SPLITS,
        metrics=TABLE_METRICS,
        note=(
            "ACT and diffusion are LeRobot's, unchanged. They observe a flat summary of the "
            "visible set and neither a prompt nor a label, and return poses, of which the "
            "environment takes the nearest instance. ACT learned from 64,000 decisions, diffusion "
            "and `ttp_quick` from 32,000. Compare with `majority`, the rule that acts by one "
            "training preference."
        ),
    ),
    "horizons": Table(
        title="Action horizon",
        paper="LeRobot's policies are not in the paper.",
        axis="decisions that ACT carries out for each observation",
        rows={str(number): act(number) for number in (1, 4)},
        splits=("val",),
        metrics=("PE", "Score"),
        note=(
            "The recipe `act` chooses one decision at a time. How many of its sampled decisions "
            "`diffusion` carries out is set at evaluation alone: `kitchen-prefs evaluate` takes "
            "`--policy.n_action_steps`."
        ),
    ),
    "final_state": Table(
        title="A prompt of the final arrangement alone",
        paper=(
            "A preference is more than the final arrangement, which earlier work encodes: the "
            "order is lost. No figures."
        ),
        axis="test split",
        rows={
            "TTP, ttp_quick": QUICK,
            "TTP, ttp_final": Committed("ttp_final"),
            "symbolic": RULES["symbolic"],
        },
        splits=TEST_SPLITS,
        metrics=("ED_c", "PE", "Score", "ED", "TE", "Success"),
        note=(
            "`ttp_final` is `ttp_quick` with another prompt, trained three times as long: the "
            "dishes in both racks when each rack was last visible, without time. Which rack was "
            "first is lost; which dish was first shows only in its distance to the corner, and "
            "relabelling, which samples the poses in its prompts, blurs that."
        ),
    ),
    "attributes": Table(
        title="Attributes of an instance",
        paper=(
            "Every attribute helps: pose most, then category, then time. With all three PE is "
            ".606, without the pose .142 at most."
        ),
        axis="attributes that the policy observes",
        rows={
            "nothing": hidden("pose", "category", "time"),
            "time": hidden("pose", "category"),
            "category": hidden("pose", "time"),
            "category, time": hidden("pose"),
            "pose": hidden("category", "time"),
            "pose, time": hidden("category"),
            "pose, category": hidden("time"),
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
        note=(
            "Beside the encoders, the recipe's geometric attention and learned shapes take extents "
            "and poses as they are, unless they are hidden. The recipe hides the time of a "
            "situation (`situation_time` is false), so time is that of the prompt alone."
        ),
    ),
    "preferences": Table(
        title="The number of training preferences",
        paper=(
            "On unseen preferences PE rises up to four training preferences and is about the same "
            "from four to seven (a curve without numbers)."
        ),
        axis="training preferences, 80 demonstrations each",
        rows={str(number): preferences(number) for number in range(1, 7)} | {"7": BASE},
        splits=("unseen_preferences",),
        metrics=("PE", "Score"),
        note=(
            "The recipe relabels the categories of its demonstrations. Where no training "
            "preference puts a category into a rack, no pose is known for a dish that is "
            "relabelled to that category there: it keeps its old pose, which gives its old "
            "category away. That concerns the rows 1 to 5; from six preferences on, every category "
            "is placed in both racks."
        ),
    ),
    "demonstrations": Table(
        title="The number of demonstrations",
        paper=(
            "PE on seen preferences rises with the number of demonstrations up to the last (a "
            "curve without numbers)."
        ),
        axis="demonstrations of each of the seven training preferences",
        rows={str(number): demonstrations(number) for number in (10, 20, 40, 60)} | {"80": BASE},
        splits=("seen",),
        metrics=("PE", "Score"),
    ),
    "counts": Table(
        title="The number of dishes",
        paper=(
            "Trained on 6 and 7 dishes per rack, TTP does well on 5 to 7 and worse the further "
            "away: PE is .62 on the numbers of training, .34 on the others. With 3 or 4 dishes it "
            "closes the dishwasher early. The points of the curve have no numbers in the text."
        ),
        axis="dishes per rack, and the means of the two splits that they come from",
        rows=TTP | {"symbolic": RULES["symbolic"]},
        splits=("seen", "unseen_counts"),
        metrics=("PE",),
        paper_values={"TTP in the paper": {"seen": 0.62, "unseen_counts": 0.34}},
        by_count=True,
    ),
    "prompts": Table(
        title="The number of prompts",
        paper="The paper proposes several prompts where one shows too little; no figures.",
        axis="test split",
        rows={
            "TTP, ttp_plus, 1 prompt": Committed("ttp_plus"),
            "TTP, ttp_plus, 2 prompts": Committed("ttp_plus", prompts=2),
            "TTP, ttp_plus, 4 prompts": Committed("ttp_plus", prompts=4),
            "symbolic": RULES["symbolic"],
            "symbolic, 2 prompts": Rule("symbolic", prompts=2),
            "symbolic, 4 prompts": Rule("symbolic", prompts=4),
        },
        splits=("seen", "unseen_preferences"),
        metrics=("ED_c", "PE", "Score"),  # PE is nearly 1 in all rows
    ),
    "finetuning": Table(
        title="Fine-tuning or prompting",
        paper=(
            "A prompt adapts TTP to an unseen preference without fine-tuning; the two are not "
            "compared."
        ),
        axis="steps of fine-tuning on one demonstration of the preference",
        rows={"0": BASE} | {str(steps): FineTuning(BASE, steps) for steps in (10, 30, 100)},
        splits=("unseen_preferences",),
        metrics=("PE", "PE, other prompt", "Prompt use", "Score"),
        prompt_use=("unseen_preferences",),
        note=(
            "The policy trained on the seven preferences is fine-tuned on one demonstration of a "
            "held-out one, once for each of the five, and evaluated on the sessions of that "
            "preference alone. With the right prompt the figures show prompting and fine-tuning "
            "together, in row 0 prompting alone; with another preference's prompt they show what "
            "the weights have learned. Each episode is prompted with one of the 80 demonstrations "
            "of a preference, mostly not the one of the fine-tuning. Because held-out preferences "
            "are trained on, all rows but 0 belong to the open track."
        ),
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
            "time: table": encoding("time", "table"),
            "time: fourier": BASE,
            "time: none": hidden("time"),
            "category: fourier": BASE,
            "category: label": encoding("extents", "label"),
            "category: linear": encoding("extents", "linear"),
            "category: none": hidden("category"),
            "pose: fourier": BASE,
            "pose: linear": encoding("pose", "linear"),
            "pose: none": hidden("pose"),
        },
        splits=("val",),
        metrics=("Category accuracy", "PE"),
        note=(
            "Beside the encoders, the recipe's geometric attention and learned shapes take extents "
            "and poses as they are, so an encoder changes the embedding alone; `none` hides an "
            "attribute from them, too. The recipe hides the time of a situation "
            "(`situation_time` is false), so time is that of the prompt alone."
        ),
    ),
    "batch_size": Table(
        title="The batch size",
        paper="Category accuracy comes close to 1 (a curve without numbers for each batch size).",
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
    "history": Table(
        title="Context history",
        paper=(
            "Trained on one preference and on pick decisions alone, TTP's category accuracy on "
            "validation is above .9 for every history. A longer one learns faster at first; all "
            "reach the same (a curve without numbers)."
        ),
        axis="earlier decisions that are observed (k)",
        rows={str(decisions): history(decisions) for decisions in range(4)},
        splits=("val",),
        metrics=("Pick accuracy", "Category accuracy", "PE"),
        note=(
            "Where the paper trains on pick decisions alone, the policy here is trained on all "
            "decisions of preference 1 and measured on the picks, in the expert's states of that "
            "preference's sessions. Category accuracy counts the places, too."
        ),
    ),
    "seeds": Table(
        title="Training seeds",
        paper="Each policy was trained once, as far as the paper says.",
        axis="test split",
        rows=seeds("ttp_quick"),
        splits=("seen", "unseen_preferences"),
        metrics=("Score", "PE", "ED_c"),
        spread=True,
    ),
    "gnn_seeds": Table(
        title="Training seeds of the graph network",
        paper="Each policy was trained once, as far as the paper says.",
        axis="test split",
        rows=seeds("gnn_tuned"),
        splits=("seen", "unseen_counts"),
        metrics=("Score", "PE", "ED_c"),
        spread=True,
        note="Both splits have preferences whose labels the network was trained on.",
    ),
    "learning": Curves(
        title="Learning curves",
        paper="No training times are given.",
        rows={"ttp_quick": None, "ttp_plus": "ttp_quick", "ttp_paper": None},
        metrics=("Score", "PE", "ED_c"),
        drawn=("PE", "Score"),
        note=(
            "Each point is a checkpoint on `val`; the best by Score is the one that `select` "
            "takes. The minutes are those of the training's steps, loading included. `ttp_plus` "
            "continues the last checkpoint of `ttp_quick`, so its minutes begin after those."
        ),
    ),
}


def get_table(name: str) -> Table | Curves:
    """The table with a given name.

    Raises:
        ValueError: If there is none; the message suggests the nearest.
    """
    if name not in TABLES:
        raise ValueError(f"There is no table {name!r}. {suggest(name, TABLES)}")
    return TABLES[name]
