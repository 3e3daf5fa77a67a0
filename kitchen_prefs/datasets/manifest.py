"""The manifest of a data set, and the fingerprints of the published ones.

`meta/kitchen_prefs.json` lies in each data set: its name, data version, format, fingerprint,
and the SHA-256 of each file, so that a half-written or damaged one is found when it is opened.
`kitchen_prefs/datasets/fingerprints.json` holds the fingerprints of the published data sets.
"""

import hashlib
import json
from pathlib import Path

from kitchen_prefs.datasets.columns import fingerprint, read_columns, read_tasks
from kitchen_prefs.datasets.names import data_version_of
from kitchen_prefs.utils.files import write_json

MANIFEST = Path("meta") / "kitchen_prefs.json"
FINGERPRINTS = Path(__file__).with_name("fingerprints.json")
# How the values lie in the files. 1: a set is a list of 72 lists; 2: a flat list of numbers.
FORMAT = 2
KINDS = {
    "data_version": int,
    "format": int,
    "fingerprint": str,
    "episodes": int,
    "frames": int,
    "files": dict,
}


def write_manifest(name: str, root: Path) -> dict:
    """Write the manifest of a data set whose other files are complete."""
    columns = read_columns(root)
    manifest = {
        "name": name,
        "data_version": data_version_of(name),
        "format": FORMAT,
        "fingerprint": fingerprint(columns, read_tasks(root)),
        "episodes": int(columns["episode_index"][-1]) + 1,
        "frames": len(columns["episode_index"]),
        "files": {str(path.relative_to(root)): _sha256(path) for path in _files(root)},
    }
    write_json(root / MANIFEST, manifest)
    return manifest


def read_manifest(name: str, root: Path) -> dict:
    """Read the manifest of a data set and hold the files against it.

    Args:
        name: The data set's name.
        root: Its folder.

    Returns:
        The manifest.

    Raises:
        ValueError: If the data set is incomplete, damaged, or of another version or format.
    """
    way_out = _way_out(root)
    damaged = f"The data set {name} is damaged ({{}} is not as written); {way_out}"
    if not (root / MANIFEST).is_file():
        raise ValueError(f"The data set {name} is incomplete; {way_out}")
    manifest = _parse((root / MANIFEST).read_bytes())
    if manifest is None:
        raise ValueError(damaged.format(MANIFEST))
    version = data_version_of(name)
    if manifest["data_version"] != version:
        raise ValueError(
            f"The data set {name} is of data version {manifest['data_version']}, but this "
            f"kitchen_prefs works with version {version}; {way_out}"
        )
    wrong = _wrong_files(manifest["files"], root)
    if wrong:
        raise ValueError(damaged.format(wrong[0]))
    if manifest["format"] > FORMAT:
        raise ValueError(
            f"The data set {name} is of the later format {manifest['format']}; {way_out}"
        )
    if manifest["format"] < FORMAT:
        raise ValueError(
            f"The data set {name} is of format {manifest['format']}, but this kitchen_prefs reads "
            f"format {FORMAT}; `kitchen-prefs datasets make {name}` makes it again."
        )
    return manifest


def _way_out(root: Path) -> str:
    """What to do about a data set that is missing or not as it was written."""
    before = before_edit(root)
    if before.is_dir():
        return (
            f"an edit in place left what was there in {before}; delete the folder {root} and move "
            f"{before} back there."
        )
    return f"delete the folder {root} and ask for the data set again."


def before_edit(root: Path) -> Path:
    """Where lerobot-edit-dataset moves a data set before it edits it in place."""
    return root.with_name(f"{root.name}_old")


def is_outdated(name: str, root: Path) -> bool:
    """Whether a data set is whole and of this data version, but of an earlier format."""
    file = root / MANIFEST
    manifest = _parse(file.read_bytes()) if file.is_file() else None
    if manifest is None or manifest["data_version"] != data_version_of(name):
        return False
    return manifest["format"] < FORMAT and not _wrong_files(manifest["files"], root)


def published_fingerprint(name: str) -> str | None:
    """The fingerprint of a published data set; None for one that is not recorded, as a subset."""
    return json.loads(FINGERPRINTS.read_text())["fingerprints"].get(name)


def _files(root: Path) -> list[Path]:
    """All files that are read: those in data and meta but the manifest itself."""
    found = (path for folder in ("data", "meta") for path in (root / folder).rglob("*"))
    return sorted(path for path in found if path.is_file() and path != root / MANIFEST)


def _parse(content: bytes) -> dict | None:
    """The manifest, or None if it is not one."""
    try:
        manifest = {"format": 1} | json.loads(content)  # the first format did not name itself
        known = all(isinstance(manifest[key], kind) for key, kind in KINDS.items())
    except (ValueError, KeyError, TypeError):
        return None
    return manifest if known else None


def _wrong_files(recorded: dict, root: Path) -> list[str]:
    """The files that are missing, not recorded, or other than recorded."""
    found = {str(path.relative_to(root)): _sha256(path) for path in _files(root)}
    names = sorted(recorded.keys() | found.keys())
    return [name for name in names if recorded.get(name) != found.get(name)]


def _sha256(path: Path) -> str:
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()
