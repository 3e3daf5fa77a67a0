"""The colours of the second tier's materials, in plain numbers; both renderers draw with them.

Glaze and paint have the colours of `people.attributes.COLOURS`.
"""

from kitchen_prefs.people.attributes import COLOURS
from kitchen_prefs.rendering.state import Look

RGB = tuple[float, float, float]

# More saturated than the glaze.
PLASTIC = {
    "white": (1.0, 1.0, 1.0),
    "blue": (0.05, 0.45, 1.0),
    "red": (1.0, 0.16, 0.16),
    "green": (0.10, 0.70, 0.22),
}
# What is seen through it has the tint.
GLASS = {
    "white": (0.93, 0.97, 0.98),
    "blue": (0.25, 0.50, 0.95),
    "red": (0.95, 0.22, 0.20),
    "green": (0.25, 0.75, 0.35),
}
OPACITY = 0.36  # of glass: less, and its colour is lost; more, and it looks like plastic
CLAY = (0.78, 0.64, 0.47)  # a ceramic dish's rim
WOOD, GRAIN = (0.89, 0.73, 0.51), (0.64, 0.49, 0.31)
STAIN = (0.27, 0.14, 0.04)


def colour_of(look: Look) -> tuple[float, float, float, float]:
    """The RGBA colour that a dish shows, 0 to 1; a wooden one's is its paint's."""
    rgb = {"plastic": PLASTIC, "glass": GLASS}.get(look.material, COLOURS)[look.colour]
    return (*rgb, OPACITY if look.material == "glass" else 1.0)
