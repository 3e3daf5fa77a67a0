"""Sentences about unknown names, with what was probably meant."""

import difflib
from collections.abc import Iterable, Sequence


def suggest(name: str, known: Iterable[str]) -> str:
    """A sentence that names the nearest of some known names, or all of them."""
    names = list(known)
    near = difflib.get_close_matches(name, names, n=1)
    return f"Did you mean {near[0]!r}?" if near else f"There are: {', '.join(names)}."


def check_settings(owner: str, known: Iterable[str], options: Sequence[str]) -> None:
    """Make sure that options of the command line name known settings.

    Args:
        owner: Whose settings they are, such as "The policy".
        known: The names of its settings.
        options: Such as `--dim=64`, or `--optimizer.lr=0.1` for a part of the setting `optimizer`.

    Raises:
        ValueError: If a setting is unknown; the message suggests the nearest.
    """
    names = list(known)
    for option in options:
        name = option.removeprefix("--").partition("=")[0]
        if name.partition(".")[0] not in names:
            raise ValueError(f"{owner} has no setting {name!r}. {suggest(name, names)}")
