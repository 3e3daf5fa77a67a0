"""A plan of the kitchen before a decision: counter, racks, dishes, and what the decision chooses.

It needs no MuJoCo. The racks are drawn larger, beneath the counter; beside each stands what the
user wants in it, in order. The chosen instance has a ring. A dish in hand has an orange edge, an
arrow leads to its place, and dots are the free placements. Dishes in a rack that is in are pale: a
policy does not see them.
"""

import numpy as np

from kitchen_prefs.preferences import CATEGORIES, RACKS, Preference
from kitchen_prefs.rendering import plan_ground as ground
from kitchen_prefs.rendering.canvas import Canvas
from kitchen_prefs.rendering.dish_outlines import Outline, outline, surround
from kitchen_prefs.simulation.kitchen import (
    DOOR,
    FIRST_DISH,
    FIRST_PLACEMENT,
    IN_RACK,
    RACK_OF_INSTANCE,
    SINK,
    Kitchen,
    Location,
    placement_table,
)

# The colours of the leaderboard's page.
GLAZES = {
    "cup": "#c8402f",
    "glass": "#a9d8d6",
    "tray": "#8a4b1f",
    "small bowl": "#2c6cb0",
    "big bowl": "#5b8a45",
    "small plate": "#93bfe6",
    "big plate": "#fbf7ea",
}
EDGE, MARK, INSIDE, SHADOW = "#2a2f2c", (42, 47, 44, 150), (0, 0, 0, 40), (60, 45, 20, 70)
SHADOW_OFFSET = np.array([1.5, 2.5])  # pixels
RING, HALO, TINT, PALE = "#e8590c", "#fffdf8", "#fbdcc4", (233, 227, 213, 150)
UPRIGHT = np.array([0, 0, 0, 1, 0, 0, 0])
RING_DISTANCE = 7  # pixels from the dish
LIST_SCALE = 90  # pixels a metre, of the dishes in the lists beside the racks
LIST_STEP = 36  # pixels from one to the next


def draw_plan(
    kitchen: Kitchen, preference: Preference, instance: int, number: int, count: int
) -> np.ndarray:
    """Draw the kitchen before a decision.

    Args:
        kitchen: The kitchen, which is not changed.
        preference: The user's.
        instance: What the decision chooses.
        number: The number of the decision, from 0.
        count: How many decisions the episode has.

    Returns:
        The picture, (480, 640, 3) uint8.
    """
    canvas = Canvas(ground.WIDTH, ground.HEIGHT, ground.PAPER)
    ground.draw_title(canvas, in_words(kitchen, instance), number, count)
    ground.draw_counter(canvas, int((kitchen.location == Location.SINK).sum()))
    ground.draw_door(canvas, kitchen.door_open)
    for rack in RACKS:
        ground.draw_rack(canvas, rack, kitchen.open_rack == rack)
    _draw_dishes(canvas, kitchen)
    _draw_choice(canvas, kitchen, instance)
    for rack in RACKS:
        _draw_order(canvas, rack, preference, _category_at_issue(kitchen, instance))
    return canvas.picture()


def in_words(kitchen: Kitchen, instance: int) -> str:
    """What a decision does, before it is carried out."""
    if kitchen.held is not None:
        place = "sink" if instance == SINK else f"{_rack_of(instance)} rack"
        return f"puts the {_category(kitchen, kitchen.held)} into the {place}"
    if instance == DOOR:
        return "closes the door" if kitchen.door_open else "opens the door"
    if instance in RACK_OF_INSTANCE:
        rack = RACK_OF_INSTANCE[instance]
        return f"pushes the {rack} rack in" if kitchen.open_rack else f"pulls the {rack} rack out"
    return f"picks a {_category(kitchen, instance - FIRST_DISH)}"


def _category(kitchen: Kitchen, dish: int) -> str:
    return CATEGORIES[kitchen.dishes.category[dish]]


def _category_at_issue(kitchen: Kitchen, instance: int) -> str | None:
    """The category of the dish that is picked or placed."""
    if kitchen.held is not None:
        return _category(kitchen, kitchen.held)
    return _category(kitchen, instance - FIRST_DISH) if instance >= FIRST_DISH else None


def _rack_of(placement: int) -> str:
    return "top" if placement >= FIRST_PLACEMENT["top"] else "bottom"


def _draw_dishes(canvas: Canvas, kitchen: Kitchen) -> None:
    areas = {Location.COUNTER: ground.COUNTER} | {IN_RACK[r]: ground.RACK_AREAS[r] for r in RACKS}
    for dish in np.argsort(kitchen.pose[:, 2]).tolist():  # the lowest first
        area = areas.get(Location(kitchen.location[dish]))
        if area is not None:
            category = _category(kitchen, dish)
            _draw_dish(canvas, area, category, outline(category, kitchen.pose[dish]))
    for rack in RACKS:
        if kitchen.open_rack != rack:
            canvas.rectangle(ground.RACK_AREAS[rack].box, PALE, radius=6)


def _draw_dish(canvas: Canvas, area: ground.Area, category: str, shape: Outline) -> None:
    for part in shape.parts:
        canvas.polygon(area.place(part) + SHADOW_OFFSET, SHADOW)
    for part in shape.parts:
        canvas.polygon(area.place(part), GLAZES[category], EDGE)
    canvas.polygon(area.place(shape.mark), INSIDE if shape.inside else None, MARK)


def _draw_choice(canvas: Canvas, kitchen: Kitchen, instance: int) -> None:
    if kitchen.held is not None:
        _draw_placing(canvas, kitchen, kitchen.held, instance)
    elif instance == DOOR:
        _ring_box(canvas, ground.DOOR_BOX)
    elif instance in RACK_OF_INSTANCE:
        _ring_box(canvas, ground.RACK_AREAS[RACK_OF_INSTANCE[instance]].box)
    else:
        dish = instance - FIRST_DISH
        _ring(canvas, ground.COUNTER, outline(_category(kitchen, dish), kitchen.pose[dish]))


def _draw_placing(canvas: Canvas, kitchen: Kitchen, held: int, instance: int) -> None:
    """The dish in hand, the free placements, and the place that is chosen."""
    category = _category(kitchen, held)
    for part in outline(category, kitchen.pose[held]).parts:
        canvas.polygon(ground.COUNTER.place(part), None, RING, 2.5)
    start = ground.COUNTER.place(kitchen.pose[held, :2])
    if kitchen.open_rack is not None:
        area, poses = ground.RACK_AREAS[kitchen.open_rack], placement_table().pose
        free = kitchen.free(kitchen.open_rack, int(kitchen.dishes.category[held]))
        for pose in poses[kitchen.open_rack][free]:
            canvas.circle(area.place(pose[:2]), 2.5, ground.GREEN)
    if instance == SINK:
        _ring_box(canvas, ground.SINK.box)
        _arrow(canvas, start, ground.SINK.centre)
        return
    rack = _rack_of(instance)
    pose = placement_table().pose[rack][instance - FIRST_PLACEMENT[rack]]
    shape = outline(category, pose)
    for part in shape.parts:
        canvas.polygon(ground.RACK_AREAS[rack].place(part), TINT, RING, 1.5)
    ring = _ring(canvas, ground.RACK_AREAS[rack], shape)
    _arrow(canvas, start, ring[np.hypot(*(ring - start).T).argmin()])


def _ring(canvas: Canvas, area: ground.Area, shape: Outline) -> np.ndarray:
    """A ring round a dish, (n, 2)."""
    ring = surround(area.place(np.concatenate(shape.parts)), RING_DISTANCE)
    canvas.polygon(ring, None, HALO, 7)
    canvas.polygon(ring, None, RING, 3)
    return ring


def _ring_box(canvas: Canvas, box: tuple[float, float, float, float]) -> None:
    left, top, right, bottom = box
    canvas.rectangle((left - 4, top - 4, right + 4, bottom + 4), None, RING, 3, radius=9)


def _arrow(canvas: Canvas, start: np.ndarray, end: np.ndarray) -> None:
    along = (end - start) / np.hypot(*(end - start))
    across = np.array([-along[1], along[0]])
    neck = end - 12 * along
    canvas.line(np.stack([start, neck]), HALO, 5)
    canvas.line(np.stack([start, neck]), RING, 2.5)
    canvas.polygon(np.stack([end, neck + 6 * across, neck - 6 * across]), RING)


def _draw_order(canvas: Canvas, rack: str, preference: Preference, at_issue: str | None) -> None:
    """What the user wants in a rack, in order, beside it."""
    _, top, right, _ = ground.RACK_AREAS[rack].box
    nth = "first" if preference.first == rack else "second"
    canvas.text((right + 12, top + 6), f"load {nth}", 13, ground.SOFT, "lm")
    for place, category in enumerate(preference.order(rack)):
        y = top + 38 + LIST_STEP * place
        if category == at_issue:
            canvas.rectangle((right + 8, y - 15, right + 106, y + 15), TINT, radius=6)
        swatch = ground.Area((0.0, 0.0), (0.0, 0.0), (right + 26, y), LIST_SCALE)
        _draw_dish(canvas, swatch, category, outline(category, UPRIGHT))
        canvas.text((right + 43, y), category, 12.5, ground.INK, "lm")
