"""Pictures of the kitchen, drawn without a display.

MuJoCo draws the furniture; the dishes of a state are added to each frame as meshes, so that one
compiled model serves every session. Importing this module imports MuJoCo and OpenGL.
"""

import os
import sys

NO_DISPLAY = sys.platform == "linux" and not os.environ.get("DISPLAY")
if NO_DISPLAY:
    os.environ.setdefault("MUJOCO_GL", "egl")  # MuJoCo reads it once, when it is imported

import mujoco  # noqa: E402
import numpy as np  # noqa: E402
from scipy.spatial.transform import Rotation  # noqa: E402

from kitchen_prefs.preferences import RACKS  # noqa: E402
from kitchen_prefs.scene.dishwasher import DOOR_JOINT, rack_joint  # noqa: E402
from kitchen_prefs.scene.layout import (  # noqa: E402
    DOOR_OPEN_ANGLE,
    RACK_TRAVEL,
    SINK_POSITION,
    SINK_SIZE,
)
from kitchen_prefs.scene.model import CAMERA, Quality, kitchen_spec  # noqa: E402
from kitchen_prefs.scene.state import SceneState  # noqa: E402
from kitchen_prefs.scene.tableware import GLAZES, TRAY_MATERIAL, colour  # noqa: E402

QUALITIES = {
    "fast": Quality(samples=0, shadows=0, sides=8),  # for watching a rollout
    "fine": Quality(samples=8, shadows=4096, sides=28),  # for figures
}
SINK_PILE = 0.03  # m that each further dish in the sink lies higher


class Renderer:
    """Draws states of the kitchen.

    Args:
        width: Of the picture, in pixels.
        height: Of the picture, in pixels.
        quality: "fast" (about 30 ms a frame) or "fine" (with shadows, for figures).

    Raises:
        ValueError: If the quality is neither.
        RuntimeError: If there is no OpenGL library to draw with.
    """

    def __init__(self, width: int, height: int, quality: str) -> None:
        if quality not in QUALITIES:
            raise ValueError(f"A picture's quality is one of {sorted(QUALITIES)}, not {quality!r}.")
        self._model = kitchen_spec(QUALITIES[quality]).compile()
        self._data = mujoco.MjData(self._model)
        self._renderer = _open(self._model, width, height)

    def render(self, state: SceneState) -> np.ndarray:
        """Draw a state.

        Args:
            state: The moment to draw.

        Returns:
            The picture, (H, W, 3) uint8.
        """
        self._move_joints(state)
        self._renderer.update_scene(self._data, CAMERA)
        sunk = 0
        for number, (category, position, quaternion) in enumerate(state.dishes):
            place = np.asarray(position, dtype=float)
            if np.allclose(place, SINK_POSITION, atol=1e-4):
                place = place + _on_the_pile(sunk)
                sunk += 1
            self._add_dish(number, category, place, quaternion)
        return self._renderer.render()

    def close(self) -> None:
        """Give the OpenGL context back."""
        self._renderer.close()

    def _move_joints(self, state: SceneState) -> None:
        self._data.joint(DOOR_JOINT).qpos = DOOR_OPEN_ANGLE * state.door_open
        for rack, out in zip(RACKS, (state.bottom_out, state.top_out), strict=True):
            self._data.joint(rack_joint(rack)).qpos = RACK_TRAVEL * out
        mujoco.mj_kinematics(self._model, self._data)
        mujoco.mj_camlight(self._model, self._data)

    def _add_dish(
        self, number: int, category: str, position: np.ndarray, quaternion: np.ndarray
    ) -> None:
        """Append a dish to the frame, at the frame of its mesh, which MuJoCo has moved."""
        mesh = self._model.mesh(category).id
        turn = Rotation.from_quat(quaternion, scalar_first=True)
        own_turn = Rotation.from_quat(self._model.mesh_quat[mesh], scalar_first=True)
        scene = self._renderer.scene
        geom = scene.geoms[scene.ngeom]
        mujoco.mjv_initGeom(
            geom,
            type=mujoco.mjtGeom.mjGEOM_MESH,
            size=np.ones(3),
            pos=position + turn.apply(self._model.mesh_pos[mesh]),
            mat=(turn * own_turn).as_matrix().ravel(),
            rgba=np.array(colour(category, number), dtype=np.float32),
        )
        geom.dataid = 2 * mesh  # even numbers are meshes, odd ones their convex hulls
        geom.specular, geom.shininess = GLAZES[category].specular, GLAZES[category].shininess
        if category == "tray":
            geom.matid, geom.texcoord = self._model.material(TRAY_MATERIAL).id, 1
        scene.ngeom += 1


def _open(model: mujoco.MjModel, width: int, height: int) -> mujoco.Renderer:
    try:
        return mujoco.Renderer(model, height, width)
    except (ImportError, RuntimeError, AttributeError, mujoco.FatalError) as error:
        raise RuntimeError(
            "Pictures need an OpenGL library that draws without a display: on Debian or Ubuntu, "
            "`apt install libegl1 libegl-mesa0 libgl1-mesa-dri`. Everything but pictures works "
            "without it."
        ) from error


def _on_the_pile(below: int) -> np.ndarray:
    """Where the next dish in the sink lies: all share one pose, which would look like one dish."""
    angle = 2.4 * below  # the golden angle spreads them evenly
    reach = 0.15 * np.array(SINK_SIZE[:2]) * (below > 0)
    return np.array([reach[0] * np.cos(angle), reach[1] * np.sin(angle), SINK_PILE * below])
