"""The tables of the paper: what is evaluated on what, and what the paper says.

The paper gives most of its figures as curves; only numbers that stand in its text are repeated.
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
)
from kitchen_prefs_experiments.paper.table_types import Curves, Table

ALL_METRICS = ("PE", "Score", "ED_c", "ED", "TE", "Success")

TABLES: dict[str, Table | Curves] = {  # by worth
    "main": Table(
        title="The test splits",
        paper=(
            "TTP packs .62 of what the expert packs on seen preferences, .54 on unseen ones and "
            ".34 on unseen numbers of dishes. Its graph network, which is told the preference, "
            "reaches .34 on seen preferences by imitation and .017 ± .002 by reinforcement; random "
            "decisions do not solve the task at all."
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
        title="Graph networks that are told the preference",
        paper=(
            "GNN-IL, told the preference's label, packs .34 of what the expert packs on seen "
            "preferences, and no less on unseen ones, whose labels it is told, too (no figure)."
        ),
        axis="test split",
        rows=GNN_IL | {"TTP, ttp_quick": QUICK} | TTP | {"symbolic": RULES["symbolic"]},
        splits=TEST_SPLITS,
        metrics=ALL_METRICS,
        paper_values={"GNN-IL in the paper": {"seen": 0.34}},
        note=(
            "The GNN rows are of the privileged track: the label is an input. There are twelve "
            "inputs for it, five of which `dishwasher-train-v1` never sets; the rows named `_all` "
            "are trained on `dishwasher-train-all-v1`, which shows all twelve preferences. Whoever "
            "is none of the twelve, as on `many_preferences`, has no input. `gnn_paper`, "
            "`gnn_paper_all` and `gnn_tuned` learned from 128,000 decisions, `gnn_tuned_all` went "
            "on from `gnn_tuned` for 96,000, `ttp_quick` learned from 32,000. LeRobot clips "
            "gradients at a norm of 10 for `gnn_paper`, of which the paper says nothing; its rows "
            "are drawn by their probabilities, without which it packs half as much on `val`. TTP, "
            "in the standard track, reads a prompt instead."
        ),
    ),
    "reinforcement": Table(
        title="Learning from rewards",
        paper=(
            "GNN-RL, after 32,000 interactions of PPO, packs .017 ± .002, random decisions about "
            "nothing: sessions of more than thirty decisions are too long for it."
        ),
        axis="test split",
        rows=GNN_RL | {"random": RULES["random"], "symbolic": RULES["symbolic"]},
        splits=TEST_SPLITS,
        metrics=ALL_METRICS,
        paper_values={"GNN-RL in the paper": {"seen": 0.017}},
        note=(
            "The GNN rows are of the open track, because they learn in the kitchen, and they are "
            "told the label. An interaction is one decision here, a pick or a place; the paper "
            "does not say which split its figure is of. Masked, PPO chose among what the kitchen "
            "would carry out while it learned. Evaluated, no policy has a mask, and rows are drawn "
            "by their probabilities, as they are in training."
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
        metrics=ALL_METRICS,
        note=(
            "ACT and diffusion are LeRobot's, unchanged. They see a flat summary of the visible "
            "set and neither a prompt nor a label, and return poses, to which the kitchen takes "
            "the nearest instance. ACT learned from 64,000 decisions, diffusion and `ttp_quick` "
            "from 32,000. The yardstick is `majority`, the rule that acts by one training "
            "preference."
        ),
    ),
    "horizons": Table(
        title="Decisions at a time",
        paper="LeRobot's policies are not in the paper.",
        axis="how many decisions ACT chooses from what it has seen once",
        rows={str(number): act(number) for number in (1, 4)},
        splits=("val",),
        metrics=("PE", "Score"),
        note=(
            "The recipe `act` chooses one at a time. How many decisions `diffusion` carries out of "
            "those that it has drawn is a matter of playing alone: `evaluate` takes "
            "`--policy.n_action_steps`."
        ),
    ),
    "final_state": Table(
        title="A prompt of the final arrangement alone",
        paper=(
            "A preference is more than where everything stands in the end, which earlier work "
            "encodes: the order is lost. No figures."
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
            "dishes in both racks when each rack was last seen, without time. Which rack came "
            "first is lost; which dish came first shows only in how far from the corner each "
            "stands, and relabelling, which draws the places of its prompts at random, blurs that."
        ),
    ),
    "attributes": Table(
        title="What is seen of an instance",
        paper=(
            "Every attribute helps: pose most, then category, then time. With all three PE is "
            ".606, without the pose at most .142."
        ),
        axis="attributes that the policy sees",
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
            "Beside the encoders, the recipe's geometric attention and learned shapes see extents "
            "and poses as they are, unless they are hidden. The recipe does not show the time of a "
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
            "preference puts a category into a rack, no pose is known for a dish that becomes one "
            "of that category there: it keeps its old pose, which tells its old category. That "
            "concerns the rows 1 to 5; from six preferences on, every category stands in both "
            "racks."
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
            "away: .62 on the numbers that it has seen, .34 on the others. With 3 or 4 dishes it "
            "closes the dishwasher early. The curve's points have no numbers in the text."
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
        paper="The paper proposes several prompts against one that shows too little; no figures.",
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
        title="Fine-tuning on the demonstration against prompting with it",
        paper=(
            "A prompt is to adapt TTP to an unseen preference without fine-tuning; the two are not "
            "compared."
        ),
        axis="steps of fine-tuning on one demonstration of the preference",
        rows={"0": BASE} | {str(steps): FineTuning(BASE, steps) for steps in (10, 30, 100)},
        splits=("unseen_preferences",),
        metrics=("PE", "PE, other prompt", "Prompt use", "Score"),
        prompt_use=("unseen_preferences",),
        note=(
            "A row that the paper asks for and does not have. The policy trained on the seven "
            "preferences goes on with one demonstration of a held-out one, once for each of the "
            "five, and is played on the sessions of that preference alone. With the right prompt "
            "the figures say what prompting and fine-tuning reach together, in row 0 what "
            "prompting reaches alone; with another preference's prompt they say what the weights "
            "have learned. Each episode is prompted with one of the 80 demonstrations of a "
            "preference, mostly not the one that was fine-tuned on. Because held-out preferences "
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
            "Beside the encoders, the recipe's geometric attention and learned shapes see extents "
            "and poses as they are, so an encoder changes the embedding alone; `none` hides an "
            "attribute from them, too. The recipe does not show the time of a situation "
            "(`situation_time` is false), so time is that of the prompt alone."
        ),
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
    "history": Table(
        title="Context history",
        paper=(
            "Trained on one preference and on pick decisions alone, TTP's category accuracy on "
            "validation is above .9 for every history. A longer one learns faster at first; all "
            "end alike (a curve without numbers)."
        ),
        axis="earlier decisions in sight (k)",
        rows={str(decisions): history(decisions) for decisions in range(4)},
        splits=("val",),
        metrics=("Pick accuracy", "Category accuracy", "PE"),
        note=(
            "Where the paper trains on pick decisions alone, the policy here is trained on all "
            "decisions of preference 1 and measured on the picks, in the expert's states of that "
            "preference's sessions. Category accuracy counts the places, too."
        ),
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
            "goes on from the last checkpoint of `ttp_quick`, so its minutes begin after those."
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
