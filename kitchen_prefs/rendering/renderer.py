"""Pictures of the kitchen, drawn without a display.

MuJoCo draws the furniture; the dishes of a state are added to each frame as meshes, so that one
compiled model serves every session.
"""

import numpy as np
from scipy.spatial.transform import Rotation

from kitchen_prefs.preferences import RACKS
from kitchen_prefs.rendering.opengl import NoOpenGLError, open_context
from kitchen_prefs.rendering.state import SceneDish, SceneState
from kitchen_prefs.simulation.layout import DOOR_OPEN_ANGLE, RACK_TRAVEL, SINK_POSITION, SINK_SIZE
from kitchen_prefs.utils.extras import require_mujoco

try:
    require_mujoco()
    import mujoco
except (ImportError, AttributeError) as error:  # with MUJOCO_GL set it loads OpenGL at once
    raise NoOpenGLError from error

from kitchen_prefs.rendering.dishwasher import DOOR_JOINT, rack_joint
from kitchen_prefs.rendering.finishes import Layer, layers
from kitchen_prefs.rendering.kitchen_model import VIEWS, Quality, kitchen_spec

QUALITIES = {
    "fast": Quality(samples=0, shadows=0, sides=8),  # for watching a rollout
    "fine": Quality(samples=8, shadows=4096, sides=28),  # for figures
}
MOST_GEOMS = 1000  # in a frame: the furniture has 300, each of at most 24 dishes three
SINK_PILE = 0.03  # m that each further dish in the sink lies higher


class Renderer:
    """Draws states of the kitchen.

    Args:
        width: Of the picture, in pixels.
        height: Of the picture, in pixels.
        quality: "fast" (about 30 ms a frame) or "fine" (with shadows, for figures).
        view: What is in sight, one of `kitchen_model.VIEWS`: "kitchen", a rack or "sink".

    Raises:
        ValueError: If there is no such quality or view.
        NoOpenGLError: If there is no OpenGL library to draw with.
    """

    def __init__(self, width: int, height: int, quality: str, view: str = "kitchen") -> None:
        if quality not in QUALITIES:
            raise ValueError(f"A picture's quality is one of {sorted(QUALITIES)}, not {quality!r}.")
        if view not in VIEWS:
            raise ValueError(f"A picture's view is one of {sorted(VIEWS)}, not {view!r}.")
        spec = kitchen_spec(QUALITIES[quality])
        spec.visual.global_.offwidth, spec.visual.global_.offheight = width, height
        self._model = spec.compile()
        self._data = mujoco.MjData(self._model)
        self._scene = mujoco.MjvScene(self._model, MOST_GEOMS)
        self._options = mujoco.MjvOption()
        self._camera = mujoco.MjvCamera()
        self._camera.type = mujoco.mjtCamera.mjCAMERA_FIXED
        self._camera.fixedcamid = self._model.camera(view).id
        self._frame = mujoco.MjrRect(0, 0, width, height)
        self._opengl = open_context(width, height)
        self._drawing = mujoco.MjrContext(self._model, mujoco.mjtFontScale.mjFONTSCALE_100)
        mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN, self._drawing)

    def render(self, state: SceneState) -> np.ndarray:
        """Draw a state.

        Args:
            state: The moment to draw.

        Returns:
            The picture, (H, W, 3) uint8.
        """
        self._arrange_furniture(state)
        self._arrange_dishes(state)
        self._opengl.make_current()  # another renderer may have drawn since
        mujoco.mjr_render(self._frame, self._scene, self._drawing)
        picture = np.empty((self._frame.height, self._frame.width, 3), dtype=np.uint8)
        mujoco.mjr_readPixels(picture, None, self._frame, self._drawing)
        return np.ascontiguousarray(np.flipud(picture))  # OpenGL counts rows from below

    def close(self) -> None:
        """Release the OpenGL context."""
        self._opengl.make_current()
        self._drawing.free()
        self._opengl.free()

    def _arrange_furniture(self, state: SceneState) -> None:
        self._data.joint(DOOR_JOINT).qpos = DOOR_OPEN_ANGLE * state.door_open
        for rack, out in zip(RACKS, (state.bottom_out, state.top_out), strict=True):
            self._data.joint(rack_joint(rack)).qpos = RACK_TRAVEL * out
        mujoco.mj_kinematics(self._model, self._data)
        mujoco.mj_camlight(self._model, self._data)
        mujoco.mjv_updateScene(
            self._model,
            self._data,
            self._options,
            None,
            self._camera,
            mujoco.mjtCatBit.mjCAT_ALL,
            self._scene,
        )

    def _arrange_dishes(self, state: SceneState) -> None:
        sunk = 0
        for number, dish in enumerate(state.dishes):
            place = np.asarray(dish.position, dtype=float)
            if np.allclose(place, SINK_POSITION, atol=1e-4):
                place = place + _on_the_pile(sunk)
                sunk += 1
            for layer in layers(dish.category, number, dish.look):
                self._add_layer(layer, dish, place)

    def _add_layer(self, layer: Layer, dish: SceneDish, position: np.ndarray) -> None:
        """Append a layer of a dish to the frame, where its mesh is, which MuJoCo has moved."""
        mesh = self._model.mesh(layer.mesh).id
        scale = dish.look.scale if dish.look else 1.0
        turn = Rotation.from_quat(dish.quaternion, scalar_first=True)
        own_turn = Rotation.from_quat(self._model.mesh_quat[mesh], scalar_first=True)
        geom = self._scene.geoms[self._scene.ngeom]
        mujoco.mjv_initGeom(
            geom,
            type=mujoco.mjtGeom.mjGEOM_MESH,
            size=np.ones(3),
            pos=position + scale * turn.apply(self._model.mesh_pos[mesh]),
            mat=(scale * (turn * own_turn).as_matrix()).ravel(),
            rgba=np.array(layer.rgba, dtype=np.float32),
        )
        geom.dataid = 2 * mesh  # even numbers are meshes, odd ones their convex hulls
        geom.specular, geom.shininess = layer.specular, layer.shininess
        geom.emission = layer.emission
        if layer.texture is not None:
            geom.matid, geom.texcoord = self._model.material(layer.texture).id, 1
        self._scene.ngeom += 1


def _on_the_pile(below: int) -> np.ndarray:
    """Where the next dish in the sink lies: all share one pose, which would look like one dish."""
    angle = 2.4 * below  # the golden angle spreads them evenly
    reach = 0.15 * np.array(SINK_SIZE[:2]) * (below > 0)
    return np.array([reach[0] * np.cos(angle), reach[1] * np.sin(angle), SINK_PILE * below])
