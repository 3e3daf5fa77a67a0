"""Finds the trained checkpoints by name, and verifies them.

manifest.json has the SHA-256 of each file that LeRobot reads. In a checkout the checkpoints are
beside this package, in `policies/checkpoints/`. A wheel has the small ones inside this package; the
others come from the Hugging Face hub, where each is a model repository.
"""

import json
from hashlib import sha256
from pathlib import Path

from huggingface_hub import hf_hub_download

from kitchen_prefs.utils.files import write_json
from kitchen_prefs.utils.hub import check_repo_id, hub_errors
from kitchen_prefs.utils.suggestions import suggest

MANIFEST = "manifest.json"
READ_BY_LEROBOT = ("*.json", "*.safetensors")
HUB_OWNER = "kitchen_prefs"


def checkpoints_folder() -> Path:
    """The folder of the manifest and of the checkpoints that are on this machine."""
    package = Path(__file__).parent
    installed = package / "checkpoints"
    return installed if installed.is_dir() else package.parent / "checkpoints"


def read_manifest() -> dict[str, dict[str, str]]:
    """Checkpoint -> file -> SHA-256."""
    return json.loads((checkpoints_folder() / MANIFEST).read_text())


def is_installed(name: str) -> bool:
    """Whether a checkpoint of the manifest is on this machine."""
    return (checkpoints_folder() / name).is_dir()


def find_checkpoint(name: str, repo_id: str | None = None) -> Path:
    """Find a checkpoint, download it if need be, and verify it.

    Args:
        name: Such as "ttp_quick".
        repo_id: The model repository that it is downloaded from; if not given, the checkpoint on
            this machine is taken, or else the repository `kitchen_prefs/<name>`.

    Returns:
        The checkpoint's folder.

    Raises:
        ValueError: If there is no such checkpoint, or if a file is missing or differs.
        OSError: If the hub does not answer or refuses.
    """
    manifest = read_manifest()
    if name not in manifest:
        raise ValueError(f"There is no checkpoint {name!r}. {suggest(name, manifest)}")
    if repo_id is None and is_installed(name):
        folder = checkpoints_folder() / name
    else:
        folder = _download(repo_id or f"{HUB_OWNER}/{name}", list(manifest[name]))
    for file, digest in manifest[name].items():
        if not (folder / file).is_file() or _digest(folder / file) != digest:
            raise ValueError(
                f"{folder / file} is not the file that the manifest of kitchen_prefs has; install "
                "kitchen_prefs anew, or give another --repo-id."
            )
    return folder


def record_checkpoints() -> Path:
    """Write the manifest anew, from the checkpoints on this machine.

    Returns:
        The manifest's file.
    """
    folders = sorted(path for path in checkpoints_folder().iterdir() if path.is_dir())
    manifest = {folder.name: _digests(folder) for folder in folders}
    write_json(checkpoints_folder() / MANIFEST, manifest)
    return checkpoints_folder() / MANIFEST


def _digests(folder: Path) -> dict[str, str]:
    files = sorted(file for pattern in READ_BY_LEROBOT for file in folder.glob(pattern))
    return {file.name: _digest(file) for file in files}


def _digest(file: Path) -> str:
    return sha256(file.read_bytes()).hexdigest()


def _download(repo_id: str, files: list[str]) -> Path:
    """Download files of a model repository into the hub's cache; all lie in one folder."""
    check_repo_id(repo_id)
    with hub_errors(repo_id):
        downloaded = [Path(hf_hub_download(repo_id, file)) for file in files]
    return downloaded[0].parent
