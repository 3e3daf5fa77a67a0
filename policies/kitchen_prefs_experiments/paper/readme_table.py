"""The README's table of results, written from the leaderboard's scores.json."""

from collections.abc import Sequence

from kitchen_prefs.metrics import Interval
from kitchen_prefs_experiments.markdown import interval_cell, markdown_table

BEGIN, END = "<!-- kitchen-prefs readme-table -->", "<!-- end of the table -->"
ROWS = {
    "promptless": "`promptless`: exact posterior without a prompt (floor)",
    "nearest": "`nearest`: the training preference nearest to the prompt",
    "ttp_paper": "`ttp_paper`: TTP, the paper's recipe, three hours",
    "ttp_quick": "`ttp_quick`: TTP, compact prompts, six minutes",
    "ttp_plus": "`ttp_plus`: `ttp_quick`, 45 minutes more",
    "bayes": "`bayes`: Bayes-optimal reader of the prompt (ceiling)",
}
SPLITS = ("seen", "unseen_preferences", "unseen_counts", "mean")


def replace_table(readme: str, scores: Sequence[dict]) -> str:
    """Replace the table in the README.

    Args:
        readme: Its text, with the table between the lines BEGIN and END.
        scores: The entries of scores.json.

    Raises:
        ValueError: If one of the two lines is missing.
    """
    before, begin, rest = readme.partition(BEGIN)
    _, end, after = rest.partition(END)
    if not begin or not end:
        raise ValueError(f"The README has no lines {BEGIN} and {END}, which enclose its table.")
    return f"{before}{BEGIN}\n{readme_table(scores)}\n{END}{after}"


def readme_table(scores: Sequence[dict]) -> str:
    """The table: Score by split, its mean over the six, and the mean rescaled Score.

    Rows that scores.json lacks are left out.
    """
    found = {entry["name"]: entry["splits"] for entry in scores if entry["name"] in ROWS}
    head = ["policy", *SPLITS[:-1], "mean of the six", "rescaled"]
    lines = [
        [
            label,
            *(interval_cell(Interval(**found[name][split]["Score"])) for split in SPLITS),
            interval_cell(Interval(**found[name]["mean"]["Rescaled"])),
        ]
        for name, label in ROWS.items()
        if name in found
    ]
    return markdown_table(head, lines)
