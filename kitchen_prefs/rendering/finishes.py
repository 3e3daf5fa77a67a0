"""How a dish is drawn: one layer of the first tier, layers by material in the second.

In the second tier each material shows by itself, whatever its colour:

    ceramic   a glossy glaze in the colour, and a rim of bare clay
    glass     clear, with a tint of the colour
    plastic   matt, saturated
    wood      pale wood with grain, the rim painted in the colour

Greasy dishes have brown stains.
"""

from dataclasses import dataclass

import mujoco

from kitchen_prefs.people.attributes import COMES_IN
from kitchen_prefs.preferences import CATEGORIES
from kitchen_prefs.rendering.coats import rim, stains, subdivided
from kitchen_prefs.rendering.meshes import Surface, add_surface
from kitchen_prefs.rendering.palette import CLAY, STAIN, colour_of
from kitchen_prefs.rendering.parts import add_textured_material
from kitchen_prefs.rendering.state import Look
from kitchen_prefs.rendering.tableware import GLAZES, TRAY_MATERIAL, colour, surface
from kitchen_prefs.rendering.textures import ash

RGBA = tuple[float, float, float, float]

WOODEN = "ash"  # the texture of wooden dishes
WOOD_TEXTURE = 0.4  # m that one repetition of it covers
PAINTED, BARE = 0.35, 0.12  # how much of a dish its painted rim has, and the clay one
TRAY_CUTS = 4  # the tray has few large triangles, stains need small ones


@dataclass(frozen=True)
class Layer:
    """A surface with one colour.

    Attributes:
        mesh: Its name in the model.
        rgba: Its colour, which tints the texture.
        specular: How much it reflects light, 0 to 1.
        shininess: How small its highlights are, 0 to 1.
        emission: How much of its colour is seen in shade, 0 to 1.
        texture: The material in the model whose texture it has.
    """

    mesh: str
    rgba: RGBA
    specular: float
    shininess: float
    emission: float = 0.0
    texture: str | None = None


def layers(category: str, number: int, look: Look | None) -> tuple[Layer, ...]:
    """What a dish is drawn as, the lowest layer first.

    Args:
        category: The dish's.
        number: Its number in the session, which chooses its colour in the first tier.
        look: What it is in the second tier; None in the first.
    """
    if look is None:
        glaze, texture = GLAZES[category], TRAY_MATERIAL if category == "tray" else None
        rgba = colour(category, number)
        return (Layer(category, rgba, glaze.specular, glaze.shininess, texture=texture),)
    dish = CLEAN[look.material](category, colour_of(look))
    return (*dish, Layer(f"{category} stains", (*STAIN, 1.0), 0.5, 0.5)) if look.greasy else dish


def _ceramic(category: str, rgba: RGBA) -> tuple[Layer, ...]:
    clay = Layer(f"{category} bare rim", (*CLAY, 1.0), 0.1, 0.1)
    return (Layer(category, rgba, 0.9, 0.8), clay)


def _glass(category: str, rgba: RGBA) -> tuple[Layer, ...]:
    return (Layer(category, rgba, 1.0, 0.9),)


def _plastic(category: str, rgba: RGBA) -> tuple[Layer, ...]:
    return (Layer(category, rgba, 0.0, 0.0, emission=0.15),)


def _wood(category: str, rgba: RGBA) -> tuple[Layer, ...]:
    wood = Layer(f"{category} in wood", (1.0, 1.0, 1.0, 1.0), 0.1, 0.2, texture=WOODEN)
    return (wood, Layer(f"{category} painted rim", rgba, 0.2, 0.3))


CLEAN = {"ceramic": _ceramic, "glass": _glass, "plastic": _plastic, "wood": _wood}


def add_finishes(spec: mujoco.MjSpec, sides: int) -> None:
    """Add the texture and the meshes that layers of the second tier name.

    Args:
        spec: The model; it has a mesh named after each category.
        sides: How many facets go round a dish.
    """
    add_textured_material(spec, WOODEN, ash(), 0.1, 0.2)
    for category in CATEGORIES:
        dish = surface(category, sides)
        fine = subdivided(dish, TRAY_CUTS) if category == "tray" else dish
        add_surface(spec, f"{category} stains", stains(category, fine))
        add_surface(spec, f"{category} bare rim", rim(category, dish, BARE))
        if "wood" in COMES_IN[category]:
            grain = dish.vertices[:, :2] / WOOD_TEXTURE  # as if carved from a board
            add_surface(spec, f"{category} in wood", Surface(dish.vertices, dish.faces, grain))
            add_surface(spec, f"{category} painted rim", rim(category, dish, PAINTED))
