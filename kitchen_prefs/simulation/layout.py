"""The kitchen's measures, in metres and radians.

x runs along the counter to the right, y from the cabinets' fronts into the wall, z up. The
dishwasher stands at x = 0 and opens towards -y. Everything here is plain numbers: no MuJoCo is
needed to know where things are.
"""

from math import pi

from kitchen_prefs.preferences import CATEGORIES

# Full extents (x, y, z) of the upright dish: twice the half extents that were measured on the
# paper's own assets (the cup's handle included).
EXTENTS = dict(
    zip(
        CATEGORIES,
        (
            (0.150, 0.108, 0.110),  # cup
            (0.100, 0.100, 0.138),  # glass
            (0.202, 0.276, 0.066),  # tray
            (0.164, 0.164, 0.068),  # small bowl
            (0.190, 0.188, 0.100),  # big bowl
            (0.150, 0.158, 0.020),  # small plate
            (0.250, 0.262, 0.026),  # big plate
        ),
        strict=True,
    )
)

COUNTER_HEIGHT = 0.94
COUNTER_X = (-2.40, 1.00)  # long enough for twenty dishes side by side
COUNTER_Y = (-0.03, 0.65)
COUNTER_THICKNESS = 0.04

SINK_CENTRE = (-0.75, 0.31)
SINK_SIZE = (0.52, 0.42, 0.18)  # opening x, opening y, depth
SINK_POSITION = (-0.75, 0.31, 0.80)  # the one pose that a sunk dish takes

# A rack's frame has its origin on the rack's floor, in the middle. Twice the original's area would
# pack everything; 0.46 x 0.41 m would pack six dishes out of ten. This size fills up at eight to
# ten.
RACK_INNER = (0.54, 0.51)
RACK_HEIGHT = 0.11  # of its wire walls
RACK_CLOSED = {"bottom": (0.0, 0.31, 0.20), "top": (0.0, 0.31, 0.53)}
RACK_TRAVEL = 0.60  # towards -y
RACK_HEADROOM = 0.30  # what stands higher above the floor stops the rack from closing

DOOR_SIZE = (0.596, 0.05, 0.74)
DOOR_HINGE = (0.0, 0.0, 0.12)  # its axis runs along x
DOOR_OPEN_ANGLE = pi / 2

# All poses that a decision may choose lie in between: along the counter, from the edge of the open
# door to the wall, from the floor to the tallest dish on the counter.
WORKSPACE_LOW = (COUNTER_X[0], -DOOR_SIZE[2], 0.0)
TALLEST_DISH = max(z for _, _, z in EXTENTS.values())
WORKSPACE_HIGH = (COUNTER_X[1], COUNTER_Y[1], COUNTER_HEIGHT + TALLEST_DISH)
