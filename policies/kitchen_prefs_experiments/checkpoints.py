"""Finds the trained checkpoints by name, and verifies them.

manifest.json has the SHA-256 of each file that LeRobot reads. In a checkout the checkpoints are
beside this package, in `policies/checkpoints/`; a wheel has them inside this package.
"""

import json
from hashlib import sha256
from pathlib import Path

from kitchen_prefs.utils.files import write_json
from kitchen_prefs.utils.suggestions import suggest

MANIFEST = "manifest.json"
READ_BY_LEROBOT = ("*.json", "*.safetensors")


def checkpoints_folder() -> Path:
    """The folder of the manifest and of the checkpoints."""
    package = Path(__file__).parent
    installed = package / "checkpoints"
    return installed if installed.is_dir() else package.parent / "checkpoints"


def read_manifest() -> dict[str, dict[str, str]]:
    """Checkpoint -> file -> SHA-256."""
    return json.loads((checkpoints_folder() / MANIFEST).read_text())


def find_checkpoint(name: str) -> Path:
    """Find a checkpoint and verify it.

    Args:
        name: Such as "ttp_quick".

    Returns:
        The checkpoint's folder.

    Raises:
        ValueError: If there is no such checkpoint, or if a file is missing or differs.
    """
    manifest = read_manifest()
    if name not in manifest:
        raise ValueError(f"There is no checkpoint {name!r}. {suggest(name, manifest)}")
    folder = checkpoints_folder() / name
    for file, digest in manifest[name].items():
        if not (folder / file).is_file() or _digest(folder / file) != digest:
            raise ValueError(
                f"{folder / file} is not the file that the manifest of kitchen_prefs has; install "
                "kitchen_prefs anew."
            )
    return folder


def record_checkpoints() -> Path:
    """Write the manifest anew, from the checkpoints in the folder.

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
