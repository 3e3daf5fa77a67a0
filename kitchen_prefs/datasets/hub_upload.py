"""A data set goes to the Hugging Face hub, from where LeRobot loads it by its name there.

Not through `LeRobotDataset.push_to_hub`, which puts a card of its own in the place of ours.
"""

from contextlib import suppress
from pathlib import Path

from huggingface_hub import HfApi
from huggingface_hub.errors import RevisionNotFoundError

from kitchen_prefs.datasets.loading import make_dataset
from kitchen_prefs.datasets.manifest import MANIFEST, read_manifest
from kitchen_prefs.datasets.names import content_of
from kitchen_prefs.utils.hub import check_repo_id, commit, hub_errors

CARD = "README.md"


def push_dataset(name: str, repo_id: str, private: bool = False) -> str:
    """Upload a data set to the hub after checking it.

    Args:
        name: The data set's name; it is made if it is not there.
        repo_id: Its name on the hub, OWNER/NAME.
        private: Whether a repository that is made for it is private.

    Returns:
        The data set's address.

    Raises:
        ValueError: If there is no such data set, the one on disk is wrong, or the hub cannot have
            a repository of this name.
        OSError: If the data set cannot be made, or the hub cannot be reached or refuses it.
    """
    check_repo_id(repo_id)
    content = content_of(name)
    files = _files(content.name, make_dataset(name))
    from kitchen_prefs.datasets.verification import verify_dataset  # imports LeRobot: seconds

    for _ in verify_dataset(name):
        pass
    with hub_errors(repo_id):
        api = HfApi()
        address = api.create_repo(
            repo_id, repo_type="dataset", private=private or None, exist_ok=True
        )
        commit(repo_id, "dataset", files, f"Data set {content.name}")
        _tag(api, repo_id)
    return str(address)


def _files(name: str, root: Path) -> dict[str, Path]:
    """The files of a data set: those that its manifest records, the manifest and the card."""
    if not (root / CARD).is_file():
        raise ValueError(
            f"The data set {name} lacks its card; delete the folder {root} and ask for the data "
            "set again."
        )
    recorded = read_manifest(name, root)["files"]
    return {str(path): root / path for path in (*recorded, MANIFEST, CARD)}


def _tag(api: HfApi, repo_id: str) -> None:
    """Tag the last commit with the version of LeRobot's format, which is what LeRobot loads."""
    from lerobot.datasets import CODEBASE_VERSION  # here, because it takes seconds to import

    with suppress(RevisionNotFoundError):
        api.delete_tag(repo_id, tag=CODEBASE_VERSION, repo_type="dataset")
    api.create_tag(repo_id, tag=CODEBASE_VERSION, repo_type="dataset")
