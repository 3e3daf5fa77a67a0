"""What a data set says about itself, and what the package knows of the published ones.

`meta/kitchen_prefs.json` lies in each data set: its name, data version, content fingerprint, and
the SHA-256 of each file, so that a half-written or damaged one is found when it is opened.
`kitchen_prefs/data/fingerprints.json` holds the fingerprints of the published data sets.
"""

import hashlib
import json
from importlib.resources import files
from pathlib import Path

from kitchen_prefs.datasets.columns import fingerprint, read_columns, read_tasks
from kitchen_prefs.splits import DATA_VERSION

MANIFEST = Path("meta") / "kitchen_prefs.json"
FINGERPRINTS = Path(str(files("kitchen_prefs"))) / "data" / "fingerprints.json"


def write_manifest(name: str, root: Path) -> dict:
    """Write the manifest of a data set whose other files are complete."""
    columns = read_columns(root)
    manifest = {
        "name": name,
        "data_version": DATA_VERSION,
        "fingerprint": fingerprint(columns, read_tasks(root)),
        "episodes": int(columns["episode_index"][-1]) + 1,
        "frames": len(columns["episode_index"]),
        "files": {str(path.relative_to(root)): _sha256(path) for path in _files(root)},
    }
    (root / MANIFEST).write_text(json.dumps(manifest, indent=2) + "\n")
    return manifest


def read_manifest(name: str, root: Path) -> dict:
    """Read the manifest of a data set and hold the files against it.

    Args:
        name: The data set's name.
        root: Its folder.

    Returns:
        The manifest.

    Raises:
        ValueError: If the data set is incomplete, damaged, or of another version.
    """
    way_out = f"delete the folder {root} and ask for the data set again."
    try:
        manifest = json.loads((root / MANIFEST).read_text())
        version, recorded = manifest["data_version"], manifest["files"]
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise ValueError(f"The data set {name} is incomplete; {way_out}") from error
    if version != DATA_VERSION:
        raise ValueError(
            f"The data set {name} is of data version {version}, but this kitchen_prefs works with "
            f"version {DATA_VERSION}; {way_out}"
        )
    for file, digest in recorded.items():
        if not (root / file).is_file() or _sha256(root / file) != digest:
            raise ValueError(
                f"The data set {name} is damaged ({file} is not as written); {way_out}"
            )
    return manifest


def published_fingerprint(name: str) -> str | None:
    """The fingerprint of a published data set; None for a subset of train."""
    return json.loads(FINGERPRINTS.read_text())["fingerprints"].get(name)


def _files(root: Path) -> list[Path]:
    """All files of a data set but the manifest itself."""
    return sorted(path for path in root.rglob("*") if path.is_file() and path != root / MANIFEST)


def _sha256(path: Path) -> str:
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()
