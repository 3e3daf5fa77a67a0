"""The hands: what the arm may know when it plans, and what the invisible hand takes."""

import pytest

pytest.importorskip("gym_hil", reason="needs the extra robot")

from kitchen_prefs.rendering.opengl import NoOpenGLError
from kitchen_prefs_robot.execution.conditions import REAL
from kitchen_prefs_robot.execution.hands import ArmHand
from kitchen_prefs_robot.execution.looking import CameraEyes
from kitchen_prefs_robot.execution.whereabouts import drawer_of
from kitchen_prefs_robot.motion.outcomes import Result
from kitchen_prefs_robot.scene import World, sample_scene


def test_with_all_parts_real_nothing_true_is_read(monkeypatch):
    world = World(sample_scene(2, ("small bowl",)))
    world.set_drawer("lower", 0.28)
    try:
        eyes = CameraEyes(world, REAL, 2)
    except NoOpenGLError:
        pytest.skip("needs EGL")
    look, hand = eyes.look(), ArmHand(world, REAL.grasp_failures, 2)
    eyes.close()

    def truth(*_):
        raise AssertionError("the true state of the world is not to be read")

    with monkeypatch.context() as patch:
        patch.setattr(World, "drawer_opening", truth)
        patch.setattr(World, "dish_pose", truth)
        patch.setattr("kitchen_prefs_robot.execution.hands.highest", lambda _: 0)  # for reports
        assert hand.pick(look.dishes[0], look) is Result.DONE
        assert hand.drop("lower", 0, look) is Result.DONE
    assert drawer_of(world, 0) == "lower"
