"""Colour and depth as a camera of the scene sees them, without noise and without a display."""

from typing import Self

import mujoco
import numpy as np

from kitchen_prefs.rendering.opengl import open_context
from kitchen_prefs_robot.scene.world import World

MOST_GEOMS = 1000  # in a frame: a scene of seven dishes has 400


class Pictures:
    """Draws one world in one size; a context manager that releases OpenGL.

    Args:
        world: What is drawn, as it is at each call.
        width: Of the pictures, in pixels.
        height: Of the pictures, in pixels.

    Raises:
        NoOpenGLError: If there is no OpenGL library to draw with.
    """

    def __init__(self, world: World, width: int, height: int) -> None:
        self._world = world
        self._scene = mujoco.MjvScene(world.model, MOST_GEOMS)
        self._options, self._camera = mujoco.MjvOption(), mujoco.MjvCamera()
        self._camera.type = mujoco.mjtCamera.mjCAMERA_FIXED
        self._frame = mujoco.MjrRect(0, 0, width, height)
        self._opengl = open_context(width, height)
        # The buffer is no larger than the picture: OpenGL clears all of it each time.
        size = world.model.vis.global_
        size.offwidth, size.offheight = width, height
        self._drawing = mujoco.MjrContext(world.model, mujoco.mjtFontScale.mjFONTSCALE_100)
        mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN, self._drawing)
        self._drawing.readDepthMap = mujoco.mjtDepthMap.mjDEPTH_ZEROFAR

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._opengl.make_current()
        self._drawing.free()
        self._opengl.free()

    def colour(self, camera: str) -> np.ndarray:
        """What a camera sees, (H, W, 3) uint8; "visitor" sees the whole robot."""
        return self.colour_and_depth(camera)[0]

    def depth(self, camera: str) -> np.ndarray:
        """The distance along a camera's axis, (H, W) m, four times faster than with colour."""
        return self._draw(camera, shadows=False)[1]

    def colour_and_depth(self, camera: str) -> tuple[np.ndarray, np.ndarray]:
        """What a camera sees.

        Args:
            camera: One of `World.cameras`, or "visitor".

        Returns:
            The picture, (H, W, 3) uint8, and the distance along the camera's axis, (H, W) m.
        """
        return self._draw(camera, shadows=True)

    def _draw(self, camera: str, shadows: bool) -> tuple[np.ndarray, np.ndarray]:
        world = self._world
        self._camera.fixedcamid = world.model.camera(camera).id
        self._scene.flags[mujoco.mjtRndFlag.mjRND_SHADOW] = shadows
        mujoco.mjv_updateScene(
            world.model,
            world.data,
            self._options,
            None,
            self._camera,
            mujoco.mjtCatBit.mjCAT_ALL,
            self._scene,
        )
        self._opengl.make_current()  # another world may have been drawn since
        mujoco.mjr_render(self._frame, self._scene, self._drawing)
        shape = (self._frame.height, self._frame.width)
        colour, depth = np.empty((*shape, 3), np.uint8), np.empty(shape, np.float32)
        mujoco.mjr_readPixels(colour, depth, self._frame, self._drawing)
        # OpenGL counts rows from below.
        return np.flipud(colour).copy(), self._metres(np.flipud(depth).astype(float))

    def _metres(self, depth: np.ndarray) -> np.ndarray:
        """The distance of what OpenGL's buffer holds: 1 on the near plane, 0 on the far one."""
        planes = self._world.model.vis.map
        near, far = self._world.model.stat.extent * np.array([planes.znear, planes.zfar])
        return near * far / (near + depth * (far - near))
