"""The dishwasher: a steel cavity, a door that folds down, and two racks that slide."""

import mujoco

from kitchen_prefs.physics.rack import add_wires
from kitchen_prefs.preferences import RACKS
from kitchen_prefs.rendering.parts import add_bar, add_box
from kitchen_prefs.simulation.layout import (
    COUNTER_HEIGHT,
    COUNTER_THICKNESS,
    DOOR_HINGE,
    DOOR_OPEN_ANGLE,
    DOOR_SIZE,
    RACK_CLOSED,
    RACK_INNER,
    RACK_TRAVEL,
)

DOOR_JOINT = "door"
CAVITY_BACK = 0.60  # y
LINER = 0.008  # thickness of the cavity's steel
DOOR_FRONT = -0.022  # y of the closed door's outside, flush with the cabinets
RAIL_HEIGHT = 0.025  # above a rack's floor


def rack_joint(rack: str) -> str:
    """The name of a rack's sliding joint."""
    return f"{rack} rack"


def add_dishwasher(spec: mujoco.MjSpec) -> None:
    """Build the dishwasher, everything in and closed when all joints are 0."""
    _add_cavity(spec.worldbody)
    _add_door(spec.worldbody)
    for rack in RACKS:
        body = spec.worldbody.add_body(name=rack_joint(rack), pos=RACK_CLOSED[rack])
        body.add_joint(
            name=rack_joint(rack),
            type=mujoco.mjtJoint.mjJNT_SLIDE,
            axis=(0.0, -1.0, 0.0),
            range=(0.0, RACK_TRAVEL),
        )
        add_wires(body)


def _add_cavity(world: mujoco.MjsBody) -> None:
    half, bottom = DOOR_SIZE[0] / 2, DOOR_HINGE[2]
    top = COUNTER_HEIGHT - COUNTER_THICKNESS
    for side in (-1, 1):
        x = sorted((side * half, side * (half - LINER)))
        add_box(world, "liner", (x[0], 0.0, bottom), (x[1], CAVITY_BACK, top))
        rail = side * (RACK_INNER[0] / 2 + 0.014)
        for _, y, z in RACK_CLOSED.values():
            height = z + RAIL_HEIGHT
            add_bar(world, "steel", (rail, 0.03, height), (rail, 2 * y - 0.05, height), 0.005)
    add_box(world, "liner", (-half, 0.0, bottom - LINER), (half, CAVITY_BACK, bottom))
    add_box(world, "liner", (-half, CAVITY_BACK, bottom), (half, CAVITY_BACK + LINER, top))
    add_box(world, "dark", (-half, 0.0, bottom + DOOR_SIZE[2]), (half, CAVITY_BACK, top))


def _add_door(world: mujoco.MjsBody) -> None:
    width, thickness, height = DOOR_SIZE
    half, inside = width / 2 - 0.002, DOOR_FRONT + thickness
    # The door's motion is given, so its weight is any; MuJoCo asks for one.
    door = world.add_body(
        name="door", pos=DOOR_HINGE, mass=8.0, inertia=(1.0, 1.0, 1.0), explicitinertial=True
    )
    door.add_joint(
        name=DOOR_JOINT,
        type=mujoco.mjtJoint.mjJNT_HINGE,
        axis=(1.0, 0.0, 0.0),
        range=(0.0, DOOR_OPEN_ANGLE),
    )
    panel = height - 0.075  # above it: the control strip
    add_box(door, "cabinet", (-half, DOOR_FRONT, 0.0), (half, 0.0, panel))
    add_box(door, "door inside", (-half, 0.0, 0.0), (half, inside, panel))
    edge = half - 0.04
    add_box(door, "liner", (-edge, inside, 0.03), (edge, inside + 0.003, panel - 0.03))
    add_box(door, "dark", (-half, DOOR_FRONT, panel), (half, inside, height))
    # The soap box, and the handle on the outside.
    add_box(door, "door inside", (0.02, inside, 0.30), (0.16, inside + 0.012, 0.42))
    add_box(door, "dark", (0.045, inside + 0.012, 0.325), (0.10, inside + 0.014, 0.395))
    grip, z = DOOR_FRONT - 0.03, panel - 0.045
    add_bar(door, "steel", (-0.20, grip, z), (0.20, grip, z), 0.007)
    for x in (-0.17, 0.17):
        add_bar(door, "steel", (x, grip, z), (x, DOOR_FRONT, z), 0.005)
