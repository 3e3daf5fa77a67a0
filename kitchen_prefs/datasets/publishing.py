"""Record what the published data sets are, after a change of the data version."""

import shutil
from pathlib import Path
from tempfile import TemporaryDirectory

from kitchen_prefs.datasets.manifest import FINGERPRINTS, read_manifest
from kitchen_prefs.datasets.names import content_of, dataset_names
from kitchen_prefs.datasets.writing import write_dataset
from kitchen_prefs.splits import DATA_VERSION
from kitchen_prefs.utils.files import write_json


def record_published(cards: Path) -> None:
    """Make every published data set anew, and keep its fingerprint and its card.

    Args:
        cards: The folder for the cards, one `<name>.md` each.

    Raises:
        OSError: If something cannot be written.
    """
    cards.mkdir(parents=True, exist_ok=True)
    fingerprints = {}
    for name in dataset_names():
        with TemporaryDirectory() as folder:
            root = Path(folder) / name
            write_dataset(content_of(name), root)
            fingerprints[name] = read_manifest(name, root)["fingerprint"]
            shutil.copyfile(root / "README.md", cards / f"{name}.md")
    write_json(FINGERPRINTS, {"data_version": DATA_VERSION, "fingerprints": fingerprints})
