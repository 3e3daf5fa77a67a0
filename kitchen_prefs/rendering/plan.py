"""A plan of the kitchen before a decision: counter, racks, dishes, and what the decision chooses.

It needs no MuJoCo. The racks are drawn larger, beneath the counter; beside each stands what the
user wants in it, in order, or, in the second tier, how its dishes look. The chosen instance has a
ring. A dish in hand has an orange edge, an arrow leads to its place, and dots are the free
placements. Dishes in a rack that is in are pale: a policy does not see them.
"""

import numpy as np

from kitchen_prefs.preferences import CATEGORIES, RACKS, Preference
from kitchen_prefs.rendering import plan_ground as ground
from kitchen_prefs.rendering.canvas import Canvas
from kitchen_prefs.rendering.dish_outlines import Outline, outline, surround
from kitchen_prefs.rendering.plan_dishes import draw_dish
from kitchen_prefs.rendering.plan_lists import TINT, draw_legend, draw_order
from kitchen_prefs.rendering.state import looks_of
from kitchen_prefs.simulation.kitchen import (
    DOOR,
    FIRST_DISH,
    FIRST_PLACEMENT,
    IN_RACK,
    RACK_OF_INSTANCE,
    SINK,
    Kitchen,
    Location,
)

RING, HALO, PALE = "#e8590c", "#fffdf8", (233, 227, 213, 150)
RING_DISTANCE = 7  # pixels from the dish


def draw_plan(
    kitchen: Kitchen, preference: Preference | None, instance: int, number: int, count: int
) -> np.ndarray:
    """Draw the kitchen before a decision.

    Args:
        kitchen: The kitchen, which is not changed.
        preference: The user's; None in the second tier, whose users have none.
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
        if preference is None:
            draw_legend(canvas, rack)
        else:
            draw_order(canvas, rack, preference, _category_at_issue(kitchen, instance))
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


def _outline(kitchen: Kitchen, dish: int, pose: np.ndarray) -> Outline:
    """A dish of the kitchen in a pose, (7,)."""
    look = looks_of(kitchen)[dish]
    return outline(_category(kitchen, dish), pose, look.scale if look else 1.0)


def _category_at_issue(kitchen: Kitchen, instance: int) -> str | None:
    """The category of the dish that is picked or placed."""
    if kitchen.held is not None:
        return _category(kitchen, kitchen.held)
    return _category(kitchen, instance - FIRST_DISH) if instance >= FIRST_DISH else None


def _rack_of(placement: int) -> str:
    return "top" if placement >= FIRST_PLACEMENT["top"] else "bottom"


def _draw_dishes(canvas: Canvas, kitchen: Kitchen) -> None:
    areas = {Location.COUNTER: ground.COUNTER} | {IN_RACK[r]: ground.RACK_AREAS[r] for r in RACKS}
    looks = looks_of(kitchen)
    for dish in np.argsort(kitchen.pose[:, 2]).tolist():  # the lowest first
        area = areas.get(Location(kitchen.location[dish]))
        if area is not None:
            draw_dish(canvas, area, _category(kitchen, dish), kitchen.pose[dish], looks[dish])
    for rack in RACKS:
        if kitchen.open_rack != rack:
            canvas.rectangle(ground.RACK_AREAS[rack].box, PALE, radius=6)


def _draw_choice(canvas: Canvas, kitchen: Kitchen, instance: int) -> None:
    if kitchen.held is not None:
        _draw_placing(canvas, kitchen, kitchen.held, instance)
    elif instance == DOOR:
        _ring_box(canvas, ground.DOOR_BOX)
    elif instance in RACK_OF_INSTANCE:
        _ring_box(canvas, ground.RACK_AREAS[RACK_OF_INSTANCE[instance]].box)
    else:
        dish = instance - FIRST_DISH
        _ring(canvas, ground.COUNTER, _outline(kitchen, dish, kitchen.pose[dish]))


def _draw_placing(canvas: Canvas, kitchen: Kitchen, held: int, instance: int) -> None:
    """The dish in hand, the free placements, and the place that is chosen."""
    for part in _outline(kitchen, held, kitchen.pose[held]).parts:
        canvas.polygon(ground.COUNTER.place(part), None, RING, 2.5)
    start = ground.COUNTER.place(kitchen.pose[held, :2])
    if kitchen.open_rack is not None:
        area, poses = ground.RACK_AREAS[kitchen.open_rack], kitchen.table.pose
        free = kitchen.free(kitchen.open_rack, int(kitchen.dishes.category[held]))
        for pose in poses[kitchen.open_rack][free]:
            canvas.circle(area.place(pose[:2]), 2.5, ground.GREEN)
    if instance == SINK:
        _ring_box(canvas, ground.SINK.box)
        _arrow(canvas, start, ground.SINK.centre)
        return
    rack = _rack_of(instance)
    pose = kitchen.table.pose[rack][instance - FIRST_PLACEMENT[rack]]
    shape = _outline(kitchen, held, pose)
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
