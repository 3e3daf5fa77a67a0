"""Four users load the same dishes: their racks and their sink, from above, under their rules."""

from collections.abc import Iterator, Sequence

import numpy as np
from PIL import Image, ImageDraw, ImageFont
from tqdm import tqdm

from kitchen_prefs.people.attributes import MATERIALS
from kitchen_prefs.people.sessions import UserDemonstration, make_people_session
from kitchen_prefs.people.users import ByClass, Predicate, User, ZoneException
from kitchen_prefs.people.zones import ZONES
from kitchen_prefs.rendering.renderer import Renderer
from kitchen_prefs.rendering.state import rack_scene, sink_scene
from kitchen_prefs.simulation.kitchen import Kitchen

SESSION = ("people_train", 150)  # whose dishes they load
WIDTH, HEIGHT = 320, 240  # of a picture, pixels
GAP, CAPTION = 8, 148  # pixels between pictures, and of the words above a column
PAPER, INK, SOFT = "#fffdf8", "#22302a", "#57625b"
VIEWS = {"top": "top rack", "bottom": "bottom rack", "sink": "sink"}
COLOURS_KEPT = 256  # of the picture: a third of the bytes, and the eye misses none


def _zones(*names: str) -> tuple[int, ...]:
    return tuple(ZONES.index(name) for name in names)


# Each user under the rules in words.
USERS = {
    (
        "By kind",
        "Drinks top left, bowls top right, plates",
        "bottom left, trays bottom right.",
        "Wood is washed by hand.",
        "Plates first; places from the far left.",
    ): User(
        hand=Predicate(material=MATERIALS.index("wood")),
        exceptions=(),
        base=ByClass("family", _zones("top left", "top right", "bottom left", "bottom right")),
        overflow="other side, then other rack",
        first="bottom",
        order=ByClass("family", (1, 2, 0, 3)),
        style="far left corner",
    ),
    (
        "By material",
        "Glass top left, plastic top right, ceramic",
        "bottom left, wood bottom right.",
        "But what is greasy goes bottom right.",
        "Glass first; places from the near right.",
    ): User(
        hand=None,
        exceptions=(ZoneException(Predicate(greasy=True), ZONES.index("bottom right")),),
        base=ByClass("material", _zones("bottom left", "top left", "top right", "bottom right")),
        overflow="other side, then other rack",
        first="top",
        order=ByClass("material", (2, 0, 1, 3)),
        style="near right corner",
    ),
    (
        "By colour",
        "White top left, blue top right, red",
        "bottom left, green bottom right.",
        "Nothing is washed by hand.",
        "No order; like stands beside like.",
    ): User(
        hand=None,
        exceptions=(),
        base=ByClass("colour", _zones("top left", "top right", "bottom left", "bottom right")),
        overflow="other side, then other rack",
        first="top",
        order=None,
        style="beside its family",
    ),
    (
        "By size",
        "Small ones top left, middling ones top right,",
        "large ones bottom left.",
        "Red ones go bottom right; plastic by hand.",
        "Large ones first; like stands apart from like.",
    ): User(
        hand=Predicate(material=MATERIALS.index("plastic")),
        exceptions=(ZoneException(Predicate(colour=2), ZONES.index("bottom right")),),
        base=ByClass("size", _zones("top left", "top right", "bottom left")),
        overflow="other rack, then other side",
        first="bottom",
        order=ByClass("size", (2, 1, 0)),
        style="apart from its family",
    ),
}


def draw_users() -> Image.Image:
    """Draw the users side by side: the top rack, the bottom rack and the sink of each."""
    dishes = make_people_session(*SESSION).dishes
    kitchens = [
        UserDemonstration(dishes, user.plan(dishes)).trajectory.kitchen for user in USERS.values()
    ]
    width, height = len(USERS) * (WIDTH + GAP) - GAP, CAPTION + len(VIEWS) * (HEIGHT + GAP) - GAP
    figure = Image.new("RGB", (width, height), PAPER)
    for column, caption in enumerate(USERS):
        _write(figure, column * (WIDTH + GAP), caption)
    for row, view in enumerate(tqdm(VIEWS, "figure", unit="row")):
        top = CAPTION + row * (HEIGHT + GAP)
        for column, picture in enumerate(_pictures(kitchens, view)):
            figure.paste(Image.fromarray(picture), (column * (WIDTH + GAP), top))
        words = ImageDraw.Draw(figure)
        words.text((6, top + HEIGHT - 6), VIEWS[view], PAPER, ImageFont.load_default(15), "ls")
    return figure.quantize(COLOURS_KEPT)


def _pictures(kitchens: Sequence[Kitchen], view: str) -> Iterator[np.ndarray]:
    """A rack pulled out, or the sink, of each kitchen from above, (H, W, 3) uint8."""
    renderer = Renderer(WIDTH, HEIGHT, "fine", view)
    for kitchen in kitchens:
        yield renderer.render(sink_scene(kitchen) if view == "sink" else rack_scene(kitchen, view))
    renderer.close()


def _write(figure: Image.Image, left: int, caption: tuple[str, ...]) -> None:
    """Write a user's rules above the column."""
    draw = ImageDraw.Draw(figure)
    draw.text((left + 4, 10), caption[0], INK, ImageFont.load_default(24))
    for number, line in enumerate(caption[1:]):
        draw.text((left + 4, 46 + 22 * number), line, SOFT, ImageFont.load_default(15))
