"""The room round the dishwasher: cabinets, counter, sink, tap, wall and floor."""

from itertools import pairwise

import mujoco
import numpy as np

from kitchen_prefs.rendering.meshes import Surface, add_surface, joined, smooth, tube, turned
from kitchen_prefs.rendering.parts import add_bar, add_box, add_mesh, add_slab
from kitchen_prefs.simulation.layout import (
    COUNTER_HEIGHT,
    COUNTER_THICKNESS,
    COUNTER_X,
    COUNTER_Y,
    DOOR_SIZE,
    SINK_CENTRE,
    SINK_SIZE,
)

PLINTH = 0.10  # height of the dark base under the cabinets
TOP = COUNTER_HEIGHT - COUNTER_THICKNESS  # of the cabinets
FRONT = -0.022  # y of the cabinets' outside
BOARD = 0.018  # thickness of fronts and panels
GAP = 0.0015  # half the gap between two fronts
FRAME = 0.055  # width of the frame on a front
ROOM = ((-5.0, -5.0), (4.0, COUNTER_Y[1]))  # corners of the floor
CEILING = 2.6
SPLASH_TOP = 1.75  # of the tiled wall


def add_room(spec: mujoco.MjSpec) -> None:
    """Build everything that does not move."""
    _add_walls(spec)
    _add_counter(spec)
    _add_cabinets(spec.worldbody)
    _add_sink(spec.worldbody)
    _add_tap(spec)
    _add_shelf(spec)


def _add_walls(spec: mujoco.MjSpec) -> None:
    (left, front), (right, back) = ROOM
    add_slab(spec, "floor", "oak", (left, front, -0.02), (right, back, 0.0))
    add_box(spec.worldbody, "wall", (left, back, 0.0), (right, back + 0.1, CEILING))
    add_slab(
        spec,
        "splash",
        "tiles",
        (COUNTER_X[0], back - 0.008, COUNTER_HEIGHT),
        (COUNTER_X[1], back, SPLASH_TOP),
    )


def _add_counter(spec: mujoco.MjSpec) -> None:
    (left, right), (front, back) = COUNTER_X, COUNTER_Y
    (x, y), (width, depth, _) = SINK_CENTRE, SINK_SIZE
    slabs = {
        "counter left": ((left, front), (x - width / 2, back)),
        "counter right": ((x + width / 2, front), (right, back)),
        "counter before sink": ((x - width / 2, front), (x + width / 2, y - depth / 2)),
        "counter behind sink": ((x - width / 2, y + depth / 2), (x + width / 2, back)),
    }
    for name, (low, high) in slabs.items():
        add_slab(spec, name, "walnut", (*low, TOP), (*high, COUNTER_HEIGHT))


def _add_cabinets(world: mujoco.MjsBody) -> None:
    left, right = COUNTER_X[0] + 0.02, COUNTER_X[1] - 0.02
    machine = DOOR_SIZE[0] / 2
    back = COUNTER_Y[1]
    for x in (left, -machine - BOARD, machine, right - BOARD):
        add_box(world, "cabinet", (x, 0.0, PLINTH), (x + BOARD, back, TOP))
    add_box(world, "dark", (left + BOARD, 0.05, 0.0), (right - BOARD, back, PLINTH))
    doors = np.linspace(left, -machine, 5)
    for number, (start, end) in enumerate(pairwise(doors)):
        _add_front(world, (start, end), (PLINTH, TOP))
        x = end - 0.05 if number % 2 == 0 else start + 0.05  # doors open in pairs
        _add_handle(world, (x, TOP - 0.27), (x, TOP - 0.08))
    for bottom, top in ((PLINTH, 0.40), (0.40, 0.68), (0.68, TOP)):
        _add_front(world, (machine, right), (bottom, top))
        middle, height = (machine + right) / 2, top - 0.07
        _add_handle(world, (middle - 0.12, height), (middle + 0.12, height))


def _add_front(world: mujoco.MjsBody, x: tuple[float, float], z: tuple[float, float]) -> None:
    """A door or a drawer: a panel within a raised frame."""
    left, right, bottom, top = x[0] + GAP, x[1] - GAP, z[0] + GAP, z[1] - GAP
    face, panel = FRONT, FRONT + 0.007
    add_box(world, "cabinet", (left, panel, bottom), (right, FRONT + BOARD, top))
    for low, high in (
        ((left, bottom), (left + FRAME, top)),
        ((right - FRAME, bottom), (right, top)),
        ((left + FRAME, bottom), (right - FRAME, bottom + FRAME)),
        ((left + FRAME, top - FRAME), (right - FRAME, top)),
    ):
        add_box(world, "cabinet frame", (low[0], face, low[1]), (high[0], panel, high[1]))


def _add_handle(
    world: mujoco.MjsBody, start: tuple[float, float], end: tuple[float, float]
) -> None:
    """A bar on two pins; the ends are (x, z)."""
    grip = FRONT - 0.028
    add_bar(world, "steel", (start[0], grip, start[1]), (end[0], grip, end[1]), 0.006)
    for part in (0.1, 0.9):
        x, z = (a + part * (b - a) for a, b in zip(start, end, strict=True))
        add_bar(world, "steel", (x, grip, z), (x, FRONT, z), 0.004)


def _add_sink(world: mujoco.MjsBody) -> None:
    (x, y), (width, depth, drop) = SINK_CENTRE, SINK_SIZE
    left, right, front, back = x - width / 2, x + width / 2, y - depth / 2, y + depth / 2
    bottom, rim = COUNTER_HEIGHT - drop, COUNTER_HEIGHT + 0.002
    steel, lip = 0.003, 0.012
    add_box(world, "basin", (left, front, bottom - steel), (right, back, bottom))
    for low, high in (
        ((left, front), (left + steel, back)),
        ((right - steel, front), (right, back)),
        ((left, front), (right, front + steel)),
        ((left, back - steel), (right, back)),
    ):
        add_box(world, "basin", (*low, bottom), (*high, COUNTER_HEIGHT))
    for low, high in (
        ((left - lip, front - lip), (left, back + lip)),
        ((right, front - lip), (right + lip, back + lip)),
        ((left, front - lip), (right, front)),
        ((left, back), (right, back + lip)),
    ):
        add_box(world, "steel", (*low, COUNTER_HEIGHT), (*high, rim))
    world.add_geom(
        type=mujoco.mjtGeom.mjGEOM_CYLINDER,
        pos=(x, y, bottom),
        size=(0.035, 0.002, 0.0),
        material="dark",
        contype=0,
        conaffinity=0,
    )


def _add_tap(spec: mujoco.MjSpec) -> None:
    x, y = SINK_CENTRE[0], SINK_CENTRE[1] + SINK_SIZE[1] / 2 + 0.05
    z = COUNTER_HEIGHT
    neck = smooth([(0.0, 0.0), (0.0, 0.22), (0.02, 0.285), (0.08, 0.315), (0.14, 0.285),
                   (0.155, 0.24), (0.155, 0.21)], 30)  # fmt: skip
    path = np.array([(x, y - forward, z + up) for forward, up in neck])
    add_surface(spec, "tap", tube(path, 0.012, 16))
    add_mesh(spec.worldbody, "tap", "steel")
    add_bar(spec.worldbody, "steel", (x + 0.09, y, z), (x + 0.09, y, z + 0.05), 0.015)
    add_bar(spec.worldbody, "steel", (x + 0.09, y, z + 0.06), (x + 0.13, y - 0.03, z + 0.09), 0.006)


def _add_shelf(spec: mujoco.MjSpec) -> None:
    """A shelf with two plants."""
    back, z = COUNTER_Y[1] - 0.008, 1.46
    add_slab(spec, "shelf", "walnut", (0.05, back - 0.18, z), (0.85, back, z + 0.03))
    for number, (x, scale) in enumerate(((0.22, 1.0), (0.68, 0.75))):
        _add_plant(spec, f"plant {number}", np.array([x, back - 0.09, z + 0.03]), scale)


def _add_plant(spec: mujoco.MjSpec, name: str, foot: np.ndarray, scale: float) -> None:
    pot = turned(
        scale * np.array([(0.0, 0.0), (0.038, 0.0), (0.052, 0.085), (0.056, 0.085), (0.056, 0.10),
                          (0.046, 0.10), (0.044, 0.085), (0.0, 0.085)]), 32,
    )  # fmt: skip
    rng = np.random.default_rng(round(1000 * scale))
    leaves = []
    for _ in range(16):
        angle, reach = rng.uniform(-np.pi, np.pi), rng.uniform(0.02, 0.075)
        along = np.linspace(0.0, 1.0, 8)
        aside, up = reach * along**2, 0.08 + rng.uniform(0.08, 0.19) * along
        curve = np.stack([aside * np.cos(angle), aside * np.sin(angle), up], axis=1)
        leaves.append(tube(scale * curve, scale * 0.006, 6))
    for part, material, surface in (("pot", "terracotta", pot), ("leaves", "leaf", joined(leaves))):
        mesh = f"{name} {part}"
        add_surface(spec, mesh, Surface(surface.vertices + foot, surface.faces))
        add_mesh(spec.worldbody, mesh, material)
