"""Uploads to the Hugging Face hub: a submission as a pull request, the page as a static Space.

OWNER/NAME, a data set repository       OWNER/SPACE
    FOLDER/                                 index.html    the page
        submission.json                     README.md     declares a static Space
        seen.jsonl.bz2
        ...
"""

import re
from pathlib import Path

from huggingface_hub import HfApi

from kitchen_prefs.utils.hub import check_repo_id, commit, hub_errors
from kitchen_prefs_leaderboard.scoring import read_known

SAFE_NAME = re.compile(r"[A-Za-z0-9_][A-Za-z0-9_.-]{0,59}")

SPACE_CARD = """\
---
title: kitchen_prefs leaderboard
emoji: 🍽️
colorFrom: blue
colorTo: green
sdk: static
app_file: index.html
license: apache-2.0
---

Which policy loads a dishwasher as this user likes it, after one demonstration?
`kitchen-prefs leaderboard page` wrote the page from replayed submissions.
"""


def push_submission(folder: Path, repo_id: str, name: str) -> str:
    """Propose a submission to a leaderboard by a pull request.

    It is read and checked as for scoring, but not replayed: it is scored before it is merged.

    Args:
        folder: The submission.
        repo_id: The leaderboard's data set repository, OWNER/NAME.
        name: The submission's folder there.

    Returns:
        The address of the pull request.

    Raises:
        ValueError: If it is no submission, if a name is invalid, or if it was pushed already.
        OSError: If the hub cannot be reached or refuses it.
    """
    check_repo_id(repo_id)
    if not SAFE_NAME.fullmatch(name):
        raise ValueError(
            f"{name!r} is no name for a folder on the hub; give a --name of at most 60 letters, "
            "digits, '_', '-' and '.'."
        )
    submission = read_known(folder)
    for split in submission.splits:
        submission.lines(split)  # raises if they are malformed
    files = {f"{name}/{file}": content for file, content in submission.contents.items()}
    about = submission.description
    with hub_errors(repo_id):
        HfApi().repo_info(repo_id, repo_type="dataset")  # fails at once where `commit` tries again
        proposed = commit(
            repo_id,
            "dataset",
            files,
            f"Submission {name}",
            f"{about.name}, {about.track} track, by {', '.join(about.authors)}",
            create_pr=True,
        )
    if proposed.pr_url is None:  # nothing in it differed
        raise ValueError(f"{repo_id} has this submission already, in its folder {name}.")
    return proposed.pr_url


def push_page(file: Path, repo_id: str) -> str:
    """Show the leaderboard's page as a static Space.

    Args:
        file: The page.
        repo_id: The Space, OWNER/SPACE; it is created if missing.

    Returns:
        The Space's address.

    Raises:
        ValueError: If there is no such file, or the hub cannot have a Space of this name.
        OSError: If the hub cannot be reached or refuses it.
    """
    check_repo_id(repo_id)
    if not file.is_file():
        raise ValueError(f"There is no page {file}; `kitchen-prefs leaderboard page` writes one.")
    files: dict[str, Path | bytes] = {"index.html": file, "README.md": SPACE_CARD.encode()}
    with hub_errors(repo_id):
        address = HfApi().create_repo(repo_id, repo_type="space", space_sdk="static", exist_ok=True)
        commit(repo_id, "space", files, "The leaderboard's page")
    return str(address)
