"""A scene drawn from a seed: which dishes stand where, and how the lamp shines."""

from dataclasses import dataclass

import numpy as np

from kitchen_prefs.preferences import CATEGORIES
from kitchen_prefs_robot.scene.layout import COUNTER_X, COUNTER_Y, LONGEST_REACH, STAND_HEIGHT
from kitchen_prefs_robot.scene.tableware import PALETTES, Colour, Colours, real_extents
from kitchen_prefs_robot.scene.tags import PAPER, TAGS

PAPER_DISHES = ("small bowl", "big bowl", "cup", "small plate")
GAP = 0.05  # m between two dishes: a finger of the open gripper is 3 cm thick
TAG_RADIUS = PAPER / 2**0.5  # of the circle round a tag's paper
RESTARTS, TRIES = 50, 200  # of the whole counter, and of places until it is started anew
TINT = 0.5  # the lamp's colour changes by this much of the change of its brightness


@dataclass(frozen=True)
class Dish:
    """A dish at the start.

    Attributes:
        category: One of `kitchen_prefs.preferences.CATEGORIES`.
        position: Of the middle of its box, (3,) m.
        yaw: Its turn about z, radians.
        colour: RGB of its glaze.
    """

    category: str
    position: tuple[float, float, float]
    yaw: float
    colour: Colour

    @property
    def on_stand(self) -> bool:
        """Whether it lies on a stand: plates do."""
        return self.category.endswith("plate")


@dataclass(frozen=True)
class Scene:
    """What stands on the table.

    Attributes:
        seed: That it was drawn from.
        dishes: In the order in which they were named.
        lamp: RGB by which the lamps' light is multiplied.
    """

    seed: int
    dishes: tuple[Dish, ...]
    lamp: Colour


def sample_scene(
    seed: int,
    dishes: tuple[str, ...] = PAPER_DISHES,
    colours: Colours = "distinct",
    lamp: float = 0.0,
) -> Scene:
    """Draw a scene.

    Args:
        seed: The same seed with the same arguments gives the same scene.
        dishes: The categories of the dishes, one for each.
        colours: "distinct", or "alike" for bowls and plates of one white service.
        lamp: How much the light changes at most, as a share of its brightness.

    Returns:
        The scene. Dishes stand at random on the counter, with room for the gripper in between.

    Raises:
        ValueError: If a category or the colours are unknown, or if the dishes do not fit.
    """
    unknown = sorted(set(dishes) - set(CATEGORIES))
    if unknown or colours not in PALETTES:
        raise ValueError(
            f"Dishes are of {', '.join(CATEGORIES)}, and colours are {' or '.join(PALETTES)}; "
            f"got {', '.join(map(repr, unknown or [colours]))}."
        )
    rng = np.random.default_rng([seed, len(dishes)])
    places = _places(rng, dishes)
    return Scene(
        seed,
        tuple(
            Dish(
                category,
                (x, y, _height(category)),
                float(rng.uniform(-np.pi, np.pi)),
                PALETTES[colours][category],
            )
            for category, (x, y) in zip(dishes, places, strict=True)
        ),
        _lamp(rng, lamp),
    )


def _height(category: str) -> float:
    """The height of the middle of a dish that stands on the table or lies on its stand."""
    on_stand = category.endswith("plate")
    return real_extents(category)[2] / 2 + (STAND_HEIGHT if on_stand else 0.0)


def _places(rng: np.random.Generator, dishes: tuple[str, ...]) -> list[tuple[float, float]]:
    """Where the dishes' middles stand, x and y of each.

    Raises:
        ValueError: If they do not fit.
    """
    radii = [_radius(category) for category in dishes]
    for _ in range(RESTARTS):
        places: list[tuple[float, float]] = []
        for _ in range(TRIES):
            if len(places) == len(dishes):
                return places
            x, y = rng.uniform(*COUNTER_X), rng.uniform(*COUNTER_Y)
            if _is_free((x, y), radii[len(places)], places, radii):
                places.append((float(x), float(y)))
    raise ValueError(f"{len(dishes)} dishes do not fit on the counter; name fewer.")


def _radius(category: str) -> float:
    """Of the circle round a dish, m; a tray's is that of its box."""
    width, depth, _ = real_extents(category)
    return float(np.hypot(width, depth) if category == "tray" else max(width, depth)) / 2


def _is_free(
    place: tuple[float, float],
    radius: float,
    places: list[tuple[float, float]],
    radii: list[float],
) -> bool:
    """Whether a dish can stand there: within reach, off the tags, apart from the others."""
    apart = all(
        np.hypot(place[0] - x, place[1] - y) > radius + other + GAP
        for (x, y), other in zip(places, radii, strict=False)
    )
    off_tags = all(
        np.hypot(place[0] - tag.position[0], place[1] - tag.position[1]) > radius + TAG_RADIUS
        for tag in TAGS.values()
    )
    return apart and off_tags and bool(np.hypot(*place) < LONGEST_REACH)


def _lamp(rng: np.random.Generator, change: float) -> Colour:
    """Brighter or darker, warmer or colder."""
    brightness, tint = 1.0 + change * rng.uniform(-1.0, 1.0), TINT * change * rng.uniform(-1.0, 1.0)
    return (brightness * (1.0 + tint), brightness, brightness * (1.0 - tint))
