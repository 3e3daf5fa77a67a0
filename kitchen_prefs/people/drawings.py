"""Which drawing each published session is.

The prompts of a certified split are drawn until they tell enough of the session, which takes an
exact reader some tenths of a second a drawing. For the published sessions the search has been done:
`drawings.json` has its result, which `kitchen-prefs people certify` searches anew.
"""

import json
from functools import cache
from pathlib import Path
from typing import NamedTuple

DRAWINGS = Path(__file__).with_name("drawings.json")


class Drawing(NamedTuple):
    """One of the drawings that a session could be.

    Attributes:
        user: Which drawing of its user and its dishes.
        prompts: Which drawing of that user's prompts.
    """

    user: int
    prompts: int


@cache
def published_drawings() -> dict[str, list[Drawing]]:
    """The drawings of the published sessions of each certified split, in their order."""
    recorded = json.loads(DRAWINGS.read_text())
    return {split: [Drawing(*one) for one in drawings] for split, drawings in recorded.items()}
