"""The README's table of results, written from the leaderboard's scores.json."""

from collections.abc import Mapping, Sequence

BEGIN, END = "<!-- kitchen-prefs readme-table -->", "<!-- end of the table -->"
FLOOR, CEILING = "promptless", "bayes"
ROWS = {
    FLOOR: "`promptless`: exact posterior without a prompt (floor)",
    "nearest": "`nearest`: the training preference nearest to the prompt",
    "ttp_paper": "`ttp_paper`: TTP, the paper's recipe, three hours",
    "ttp_quick": "`ttp_quick`: TTP, compact prompts, six minutes",
    "ttp_plus": "`ttp_plus`: `ttp_quick`, 45 minutes more",
    CEILING: "`bayes`: Bayes-optimal reader of the prompt (ceiling)",
}
SPLITS = ("seen", "unseen_preferences", "unseen_counts", "mean")


def replace_table(readme: str, scores: Sequence[dict]) -> str:
    """The README with its table written anew.

    Args:
        readme: Holds the lines BEGIN and END, between which the table stands.
        scores: The entries of scores.json.

    Raises:
        ValueError: If one of the two lines is missing.
    """
    before, begin, rest = readme.partition(BEGIN)
    _, end, after = rest.partition(END)
    if not begin or not end:
        raise ValueError(f"The README has no lines {BEGIN} and {END}, between which its table is.")
    return f"{before}{BEGIN}\n{readme_table(scores)}\n{END}{after}"


def readme_table(scores: Sequence[dict]) -> str:
    """The table: Score by split and its mean over the six, and the latter rescaled.

    Rows that scores.json lacks are left out; without floor and ceiling nothing is rescaled.
    """
    found = {entry["name"]: entry["splits"] for entry in scores if entry["name"] in ROWS}
    head = ["policy", *("mean of the six" if split == "mean" else split for split in SPLITS)]
    lines = [
        [label, *(_cell(found[name][split]["Score"]) for split in SPLITS)]
        for name, label in ROWS.items()
        if name in found
    ]
    if {FLOOR, CEILING} <= found.keys():
        head.append("rescaled")
        means = {name: found[name]["mean"]["Score"]["mean"] for name in ROWS if name in found}
        for line, rescaled in zip(lines, _rescaled(means), strict=True):
            line.append(f"{rescaled:.2f}")
    return "\n".join(f"| {' | '.join(line)} |" for line in (head, ["---"] * len(head), *lines))


def _rescaled(means: Mapping[str, float]) -> list[float]:
    """Means as shares of the way from the floor to the ceiling."""
    floor, ceiling = means[FLOOR], means[CEILING]
    return [(mean - floor) / (ceiling - floor) for mean in means.values()]


def _cell(interval: dict[str, float]) -> str:
    return f"{interval['mean']:.2f} [{interval['low']:.2f}, {interval['high']:.2f}]"
