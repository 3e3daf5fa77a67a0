"""Make data sets on demand, and load them."""

import warnings
from concurrent.futures import BrokenExecutor
from pathlib import Path
from typing import TYPE_CHECKING

from filelock import FileLock

from kitchen_prefs.datasets.manifest import (
    before_edit,
    is_outdated,
    published_fingerprint,
    read_manifest,
)
from kitchen_prefs.datasets.names import Content, content_of, dataset_root
from kitchen_prefs.utils.files import atomic_folder

if TYPE_CHECKING:
    from lerobot.datasets import LeRobotDataset


def load_dataset(name: str) -> "LeRobotDataset":
    """Load a data set, which is made first if it is not there.

    Args:
        name: Such as `dishwasher-train-v1`; `dataset_names()` lists the published ones.

    Returns:
        LeRobot's own data set; `lerobot-train --dataset.repo_id=kitchen_prefs/<name>` reads it too.

    Raises:
        ValueError: If there is no such data set, or the one on disk is incomplete, damaged or of
            another version.
        OSError: If it cannot be written.
    """
    root = make_dataset(name)
    from lerobot.datasets import LeRobotDataset  # here, because it takes seconds to import

    # There are no videos; LeRobot would look for a decoder and log what it does not find.
    return LeRobotDataset(content_of(name).repo_id, root=root, video_backend="pyav")


def make_dataset(name: str, workers: int | None = None) -> Path:
    """Make a data set if it is not there, or again if it is of an earlier format.

    Processes that ask for the same one at once wait for the first.

    Args:
        name: The data set's name.
        workers: How many processes; None takes all cores.

    Returns:
        The data set's folder.

    Raises:
        ValueError: If there is no such data set, or the one on disk is incomplete, damaged or of
            another version.
        OSError: If it cannot be written; nothing is left behind.
    """
    content = content_of(name)
    root = dataset_root(content.name)
    try:
        if _is_missing(content, root):
            root.parent.mkdir(parents=True, exist_ok=True)
            with FileLock(root.with_name(f".{root.name}.lock")):
                if _is_missing(content, root):
                    _make(content, root, workers)
    except (OSError, BrokenExecutor) as error:
        raise OSError(
            f"The data set {content.name} could not be made in {root.parent} ({error}); make room "
            "or let the environment variable HF_LEROBOT_HOME name another folder."
        ) from error
    manifest = read_manifest(content.name, root)
    if published_fingerprint(content.name) not in (None, manifest["fingerprint"]):
        warnings.warn(
            f"The data set {content.name} in {root} differs from the published one, so scores on "
            "it do not compare; delete the folder and ask for the data set again.",
            stacklevel=2,
        )
    return root


def _is_missing(content: Content, root: Path) -> bool:
    if not root.exists():
        if before_edit(root).is_dir():
            raise ValueError(
                f"The data set {content.name} is not in {root.parent}, but an edit in place left "
                f"it in {before_edit(root)}; move that back, or delete it."
            )
        return True
    if is_outdated(content.name, root):
        warnings.warn(
            f"The data set {content.name} in {root} is of an earlier format, so it is made again; "
            "its values stay the same.",
            stacklevel=3,
        )
        return True
    return False


def _make(content: Content, root: Path, workers: int | None) -> None:
    from kitchen_prefs.datasets.writing import write_dataset  # imports LeRobot, which takes seconds

    with atomic_folder(root) as unfinished:
        write_dataset(content, unfinished, workers)
