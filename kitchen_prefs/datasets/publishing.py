"""Record what the published data sets are, after a change of the data version or of the card."""

import json
from pathlib import Path
from tempfile import TemporaryDirectory

from kitchen_prefs.datasets.cards import card, card_facts
from kitchen_prefs.datasets.manifest import FINGERPRINTS, read_manifest
from kitchen_prefs.datasets.names import content_of, dataset_names
from kitchen_prefs.datasets.writing import write_dataset
from kitchen_prefs.utils.files import write_json

FACTS = "facts.json"  # lies beside the cards: what they say that only the data can tell


def record_published(cards: Path) -> None:
    """Make every published data set, and keep its fingerprint, the facts of its card, and the card.

    Args:
        cards: The folder for the cards, one `<name>.md` each.

    Raises:
        OSError: If something cannot be written.
    """
    cards.mkdir(parents=True, exist_ok=True)
    facts = {}
    for name in dataset_names():
        with TemporaryDirectory() as folder:
            root = Path(folder) / name
            write_dataset(content_of(name), root)
            facts[name] = card_facts(read_manifest(name, root), root)
    fingerprints = {name: of_name["fingerprint"] for name, of_name in facts.items()}
    write_json(FINGERPRINTS, {"fingerprints": fingerprints})
    write_json(cards / FACTS, facts)
    write_cards(cards)


def write_cards(cards: Path) -> None:
    """Write the cards of all published data sets from their recorded facts; no data is made.

    Args:
        cards: The folder of the cards and of their facts.

    Raises:
        OSError: If the facts are missing or a card cannot be written.
    """
    for name, text in published_cards(cards).items():
        (cards / f"{name}.md").write_text(text)


def published_cards(cards: Path) -> dict[str, str]:
    """The card of each published data set, by name, from its recorded facts."""
    facts = json.loads((cards / FACTS).read_text())
    return {name: card(content_of(name), facts[name]) for name in dataset_names()}
