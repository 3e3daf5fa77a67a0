"""The documents: cards and tables agree with the code, links lead somewhere, the site is whole."""

import re
from pathlib import Path

import pytest
import test_architecture
import yaml

from kitchen_prefs.datasets.publishing import FACTS, published_cards
from kitchen_prefs.preferences import TWELVE
from kitchen_prefs.splits import SPLITS

ROOT = Path(__file__).parents[1]
DOCS = ROOT / "docs"
PAGES = [page for page in DOCS.rglob("*.md") if page.parent.name != "prose"]
OTHERS = [ROOT / name for name in ("CONTRIBUTING.md", "CHANGELOG.md", "leaderboard/README.md")]
CHECKPOINT_CARDS = sorted((ROOT / "policies/checkpoints").glob("*/README.md"))


def test_the_committed_cards_are_written_from_their_facts():
    folder = ROOT / "dataset_cards"
    cards = {file.stem: file.read_text() for file in folder.glob("*.md")}
    assert cards == published_cards(folder), "`kitchen-prefs datasets cards` writes them"
    assert (folder / FACTS).exists()


@pytest.mark.parametrize(
    "page", [*PAGES, *OTHERS, *CHECKPOINT_CARDS], ids=lambda page: str(page.relative_to(ROOT))
)
def test_links_lead_somewhere(page):
    for target in re.findall(r"\]\((?!http)([^)#]+)(?:#[^)]*)?\)", page.read_text()):
        assert (page.parent / target).exists(), target


def test_the_site_lists_every_page():
    listed = set()

    def collect(entry):
        if isinstance(entry, str):
            listed.add(entry)
        else:
            for value in entry.values() if isinstance(entry, dict) else entry:
                collect(value)

    collect(yaml.safe_load((ROOT / "mkdocs.yml").read_text())["nav"])
    assert listed == {str(page.relative_to(DOCS)) for page in PAGES}


def test_every_room_of_the_benchmark_is_described():
    text = (DOCS / "architecture.md").read_text()
    for room in test_architecture.BENCHMARK:
        if room != "__init__":
            assert room in text


def test_the_splits_and_preferences_are_right():
    text = (DOCS / "data_format.md").read_text()
    rows = re.findall(r"\| `(\w+)` \| [^|]+ \| [^|]+ \| (\d+) \|", text)
    assert {name: int(size) for name, size in rows} == {
        name: split.sessions for name, split in SPLITS.items()
    }
    for label, preference in enumerate(TWELVE):
        orders = (
            f"{preference.first} | {', '.join(preference.top)} | {', '.join(preference.bottom)}"
        )
        assert re.search(rf"\| {label + 1} \| {label} \| [a-z ]+ \| {orders} \|", text)


def test_modules_that_the_documents_name_exist():
    places = (ROOT, ROOT / "kitchen_prefs", ROOT / "policies/lerobot_policy_kitchen_prefs")
    for page in PAGES:
        for path in re.findall(r"`([a-z_/]+/[a-z_]+\.(?:py|json|md|yml))`", page.read_text()):
            assert any((place / path).exists() for place in places), (page.name, path)
