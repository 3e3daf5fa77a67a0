"""A scene as one MuJoCo specification."""

import mujoco

from kitchen_prefs_robot.scene.arm import arm_and_gripper
from kitchen_prefs_robot.scene.furniture import add_furniture, add_stand
from kitchen_prefs_robot.scene.sampling import Scene
from kitchen_prefs_robot.scene.tableware import add_dish
from kitchen_prefs_robot.scene.tags import add_tags
from kitchen_prefs_robot.scene.views import add_views

TIMESTEP = 0.002  # s
# Friction beside the force that presses: with pyramids and 1 a plate slips out of the pads.
IMPEDANCE_RATIO = 10.0


def dish_body(number: int) -> str:
    """The body of a scene's dish, by its place in the scene's list."""
    return f"dish {number}"


def stand_geom(number: int) -> str:
    """The geom of the stand that a scene's dish lies on."""
    return f"stand {number}"


def scene_spec(scene: Scene) -> mujoco.MjSpec:
    """Put the scene together: the arm, the furniture, the dishes and what sees them."""
    spec = arm_and_gripper()
    spec.option.timestep = TIMESTEP
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    spec.option.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
    spec.option.impratio = IMPEDANCE_RATIO
    spec.option.enableflags |= mujoco.mjtEnableBit.mjENBL_SLEEP
    add_furniture(spec)
    add_tags(spec)
    add_views(spec, scene.lamp)
    for number, dish in enumerate(scene.dishes):
        add_dish(spec, dish_body(number), dish.category, dish.colour)
        if dish.on_stand:
            add_stand(spec, stand_geom(number), dish.position[:2])
    return spec
