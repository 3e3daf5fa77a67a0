"""A scene under physics: the compiled model, its state, and what can be read and set in it."""

import mujoco
import numpy as np
from numpy.typing import ArrayLike
from scipy.spatial.transform import Rotation

from kitchen_prefs_robot.scene.arm import ARM_JOINTS, HOME, OPEN
from kitchen_prefs_robot.scene.model import dish_body, scene_spec
from kitchen_prefs_robot.scene.sampling import Scene
from kitchen_prefs_robot.scene.views import CAMERAS, FIELD_OF_VIEW

SETTLING = 0.3  # s of simulated time until the dishes lie still
OPENCV = np.diag([1.0, -1.0, -1.0])  # OpenCV's cameras look along +z with y down


class World:
    """A compiled scene.

    Args:
        scene: What stands on the table. The drawers are closed and the arm is at home.

    Attributes:
        scene: As given.
        model: The compiled model.
        data: Its state.
        cameras: The names of the three cameras.
    """

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self.model = scene_spec(scene).compile()
        self.data = mujoco.MjData(self.model)
        self.cameras = CAMERAS
        for joint, angle in zip(ARM_JOINTS, HOME, strict=True):
            self.data.joint(joint).qpos = angle
        self.data.ctrl[:] = (*HOME, OPEN)
        for number, dish in enumerate(scene.dishes):
            turn = Rotation.from_euler("z", dish.yaw)
            self.set_dish_pose(number, dish.position, turn.as_quat(scalar_first=True))
        self.advance(SETTLING)

    def advance(self, seconds: float) -> None:
        """Let physics run; the arm holds or approaches what `data.ctrl` says."""
        mujoco.mj_step(self.model, self.data, round(seconds / self.model.opt.timestep))
        mujoco.mj_kinematics(self.model, self.data)  # where all is now, for who looks
        mujoco.mj_camlight(self.model, self.data)

    def dish_pose(self, number: int) -> tuple[np.ndarray, np.ndarray]:
        """The true position, (3,) m, and quaternion, (4,) wxyz, of a dish."""
        pose = self.data.joint(dish_body(number)).qpos
        return pose[:3].copy(), pose[3:].copy()

    def set_dish_pose(self, number: int, position: ArrayLike, quaternion: ArrayLike) -> None:
        """Move a dish, as a hand would, and leave it at rest.

        Args:
            number: Its place in the scene's list.
            position: (3,) m.
            quaternion: (4,) wxyz.
        """
        joint = self.data.joint(dish_body(number))
        joint.qpos[:3], joint.qpos[3:] = position, quaternion
        joint.qvel[:] = 0.0
        mujoco.mj_forward(self.model, self.data)

    def drawer_opening(self, drawer: str) -> float:
        """How far "upper" or "lower" is open, m."""
        return float(self.data.joint(drawer).qpos[0])

    def set_drawer(self, drawer: str, opening: float) -> None:
        """Open or close a drawer at once, without the arm; dishes in it stay where they are."""
        self.data.joint(drawer).qpos[0], self.data.joint(drawer).qvel[0] = opening, 0.0
        mujoco.mj_forward(self.model, self.data)

    def intrinsics(self, width: int, height: int) -> np.ndarray:
        """The cameras' matrix, (3, 3), for pictures of that many pixels.

        The middle of the first pixel is (.5, .5). MuJoCo's optical axis meets the picture half a
        pixel to the left of its middle and above it, as the tags show.
        """
        focal = height / 2 / np.tan(np.deg2rad(FIELD_OF_VIEW) / 2)
        return np.array([[focal, 0, (width - 1) / 2], [0, focal, (height - 1) / 2], [0, 0, 1.0]])

    def camera_pose(self, camera: str) -> tuple[np.ndarray, np.ndarray]:
        """The true pose of a camera, for reports of errors alone.

        Returns:
            Its position, (3,) m, and the rotation from its axes to the base's, (3, 3): x to the
            right of the picture, y down, z ahead.
        """
        seen = self.data.cam(camera)
        return seen.xpos.copy(), seen.xmat.reshape(3, 3) @ OPENCV
