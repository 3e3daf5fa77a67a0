"""Writes a submission from the episodes of a LeRobot policy."""

import bz2
import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from lerobot.configs.train import TRAIN_CONFIG_NAME
from pydantic import ValidationError
from tqdm import tqdm

from kitchen_prefs.datasets.manifest import published_fingerprint
from kitchen_prefs.evaluation.checkpoint_reading import find_checkpoint
from kitchen_prefs.evaluation.isolation.isolated_policy import IsolatedPolicy
from kitchen_prefs.evaluation.policy_loading import LoadedPolicy
from kitchen_prefs.evaluation.tiers import PREFERENCES, AnyEpisode, Tier
from kitchen_prefs.utils.files import atomic_folder
from kitchen_prefs.utils.untrusted_files import complaint
from kitchen_prefs_leaderboard.plugin_identity import find_plugin
from kitchen_prefs_leaderboard.replay import to_jsonl, write_line
from kitchen_prefs_leaderboard.submission_format import (
    ACTIONS,
    DESCRIPTION,
    UNSPECIFIED,
    Policy,
    Submission,
    installed_packages,
)


def check_replaceable(folder: Path) -> None:
    """Check that writing a submission there overwrites nothing else.

    Raises:
        ValueError: If anything but a submission is there.
    """
    known = {DESCRIPTION, *ACTIONS.values()}
    ours = folder.is_dir() and not folder.is_symlink()
    if folder.exists() and not (ours and {file.name for file in folder.iterdir()} <= known):
        raise ValueError(f"{folder} is something else than a submission; give another --out.")


def write_submission(
    submission: Submission, rolled_out: Mapping[str, Sequence[AnyEpisode]], folder: Path
) -> None:
    """Write a submission atomically.

    Args:
        submission: The description.
        rolled_out: The episodes of each test split, in the order of the sessions.
        folder: The submission's folder; an older submission there is replaced.
    """
    check_replaceable(folder)
    with atomic_folder(folder) as unfinished:
        for split, episodes in tqdm(rolled_out.items(), "Writing", unit="split", leave=False):
            lines = to_jsonl([write_line(episode) for episode in episodes])
            # A fifth smaller than gzip, and without a time stamp: equal actions give equal bytes.
            (unfinished / ACTIONS[split]).write_bytes(bz2.compress(lines))
        absent: dict[str, Any] = {} if submission.policy.plugin else {"policy": {"plugin"}}
        absent |= {"data_versions" if submission.format == 1 else "data_version": True}
        description = submission.model_dump_json(indent=2, exclude=absent)
        (unfinished / DESCRIPTION).write_text(f"{description}\n")


def describe(tiers: Sequence[Tier] = (PREFERENCES,), **about: Any) -> Submission:
    """Describe a submission, with the versions of the installed packages.

    Args:
        tiers: The tiers that it covers.
        about: The fields of a `Submission` that only its author knows.

    Raises:
        ValueError: If one of them does not follow the format.
    """
    names = [
        f"dishwasher-{split}-v{tier.data_version}" for tier in tiers for split in tier.test_splits
    ]
    published = {name: published_fingerprint(name) for name in names}
    versions = {tier.name: tier.data_version for tier in tiers}
    only_first = versions.keys() == {PREFERENCES.name}
    here = {
        "format": 1 if only_first else 2,
        "data_version": PREFERENCES.data_version if only_first else None,
        "data_versions": None if only_first else versions,
        "fingerprints": {name: one for name, one in published.items() if one is not None},
        "packages": installed_packages(),
    }
    try:
        return Submission.model_validate(here | about)
    except ValidationError as error:
        raise ValueError(f"This cannot be submitted: {complaint(error)}") from error


def policy_of(policy: LoadedPolicy | IsolatedPolicy, plugins: Path | None = None) -> Policy:
    """A LeRobot policy as a submission describes it.

    Args:
        policy: The policy.
        plugins: A folder of packages that its process alone imports from.

    Raises:
        ValueError: If its own process describes it in another way, or if its plug-in is not
            installed.
    """
    try:
        return Policy(
            type=policy.type,
            parameters=policy.parameters,
            checkpoint=policy.fingerprint,
            plugin=find_plugin(policy.plugin, plugins) if policy.plugin else None,
        )
    except ValidationError as error:
        raise ValueError(f"The policy describes itself wrongly: {complaint(error)}") from error


def training_of(path: str) -> str:
    """The training of a checkpoint in a few words, from lerobot-train's train_config.json."""
    file = find_checkpoint(path) / TRAIN_CONFIG_NAME
    try:
        config = json.loads(file.read_text())
        data = config["dataset"]["repo_id"]
        return f"{config['steps']} steps of {config['batch_size']} decisions of {data}"
    except (OSError, ValueError, KeyError, TypeError):  # another program's file, or none
        return UNSPECIFIED
