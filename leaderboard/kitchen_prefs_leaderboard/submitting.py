"""Making a submission of a LeRobot policy: it plays the test splits, and its actions are kept."""

import bz2
import json
import os
import platform
from collections.abc import Mapping, Sequence
from pathlib import Path
from shutil import rmtree
from typing import Any

from pydantic import ValidationError
from tqdm import tqdm

from kitchen_prefs.actors import Actor as LoadedActor
from kitchen_prefs.datasets.manifest import published_fingerprint
from kitchen_prefs.metrics import Episode
from kitchen_prefs.splits import DATA_VERSION, TEST_SPLITS
from kitchen_prefs_leaderboard.replay import to_jsonl, write_line
from kitchen_prefs_leaderboard.submission import (
    ACTIONS,
    DESCRIPTION,
    FORMAT,
    Actor,
    Submission,
    complaint,
    installed_packages,
)


def check_replaceable(folder: Path) -> None:
    """Make sure that nothing is lost when a submission is written there.

    Raises:
        ValueError: If something else than a submission is there.
    """
    known = {DESCRIPTION, *ACTIONS.values()}
    if folder.exists() and not (folder.is_dir() and {f.name for f in folder.iterdir()} <= known):
        raise ValueError(f"{folder} is something else than a submission; give another --out.")


def write_submission(
    submission: Submission, played: Mapping[str, Sequence[Episode]], folder: Path
) -> None:
    """Write a submission, whole or not at all.

    Args:
        submission: Who acted.
        played: The episodes of each test split, in the order of the sessions.
        folder: The submission's; an older one there is replaced.
    """
    beside = folder.with_name(f".unfinished-{folder.name}")
    rmtree(beside, ignore_errors=True)
    beside.mkdir(parents=True)
    for split, episodes in tqdm(played.items(), "Writing", unit="split", leave=False):
        lines = to_jsonl([write_line(episode) for episode in episodes])
        # A fifth smaller than gzip, and without a time in it: the same actions are the same bytes.
        (beside / ACTIONS[split]).write_bytes(bz2.compress(lines))
    (beside / DESCRIPTION).write_text(submission.model_dump_json(indent=2) + "\n")
    rmtree(folder, ignore_errors=True)
    beside.rename(folder)


def describe(**about: Any) -> Submission:
    """Say who acted, with the versions that are installed here.

    Args:
        about: The fields of a `Submission` that only its author knows.

    Raises:
        ValueError: If one of them is not as the format says.
    """
    fingerprints = {
        dataset: published_fingerprint(dataset)
        for dataset in (f"dishwasher-{split}-v{DATA_VERSION}" for split in TEST_SPLITS)
    }
    here = {
        "format": FORMAT,
        "data_version": DATA_VERSION,
        "fingerprints": fingerprints,
        "packages": installed_packages(),
    }
    try:
        return Submission.model_validate(here | about)
    except ValidationError as error:
        raise ValueError(f"This cannot be submitted: {complaint(error)}") from error


def played_by(actor: LoadedActor) -> Actor:
    """What a submission says of a LeRobot policy."""
    policy = actor.policy
    return Actor(
        type=policy.config.type,
        parameters=sum(weight.numel() for weight in policy.parameters()),
        checkpoint=actor.fingerprint,
    )


def training_of(checkpoint: Path) -> str:
    """What lerobot-train left of a training in a checkpoint, in a few words."""
    file = checkpoint / "train_config.json"
    if not file.is_file():
        return "not said"
    config = json.loads(file.read_text())
    data = config["dataset"]["repo_id"]
    return f"{config['steps']} steps of {config['batch_size']} decisions of {data}"


def this_machine() -> str:
    """What this machine is, in a few words."""
    return f"{os.cpu_count()} cores, {platform.machine()}, {platform.system()}"
