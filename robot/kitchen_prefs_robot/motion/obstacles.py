"""Whether the arm, on a planned path, would strike itself, the table, the cabinet or a stand.

The furniture's place is known, as on a real robot; where the dishes are, only the cameras can tell,
so they are left out here.
"""

import mujoco
import numpy as np

from kitchen_prefs_robot.scene import World
from kitchen_prefs_robot.scene.arm import ARM_BODY, ARM_JOINTS, PINCH
from kitchen_prefs_robot.scene.layout import DRAWERS

EVERY = 5  # commands from one check to the next: a tenth of a second
MARGIN = 0.01  # m between what the hand holds and furniture: it was seen with errors
DEPTH = 0.002  # m that two parts may overlap


class Obstacles:
    """The furniture of a world as it stands now.

    Args:
        world: Whose drawers' openings are read.
    """

    def __init__(self, world: World) -> None:
        self._model, self._data = world.model, mujoco.MjData(world.model)
        self._data.qpos[:] = world.data.qpos
        self._joints = [self._model.joint(name).qposadr[0] for name in ARM_JOINTS]
        root = self._model.body(ARM_BODY).id
        hand = self._model.body("base_mount").id
        bodies = self._model.geom_bodyid
        self._is_arm = np.array([_within(self._model, body, root) for body in bodies])
        self._is_hand = np.array([_within(self._model, body, hand) for body in bodies])
        self._is_drawer = np.isin(bodies, [self._model.body(name).id for name in DRAWERS])
        is_box = self._model.geom_type == mujoco.mjtGeom.mjGEOM_BOX
        is_furniture = self._is_drawer | (bodies == self._model.body("cabinet").id)
        self._boxes = np.flatnonzero(is_box & is_furniture)
        self._is_dish = np.array([self._model.body(b).name.startswith("dish ") for b in bodies])

    def strikes(
        self, path: np.ndarray, held: np.ndarray | None = None, but_drawers: bool = False
    ) -> bool:
        """Whether the arm, or what it holds, would strike something.

        Args:
            path: The joints, (N, 7).
            held: Points of what the hand holds, in its frame, (K, 3) m.
            but_drawers: Leaves the drawers out, for a path on which the arm moves one.
        """
        return any(
            self._arm_strikes(joints, but_drawers) or (held is not None and self._within_box(held))
            for joints in (*path[::EVERY], path[-1])
        )

    def _arm_strikes(self, joints: np.ndarray, but_drawers: bool) -> bool:
        self._data.qpos[self._joints] = joints
        mujoco.mj_kinematics(self._model, self._data)
        mujoco.mj_comPos(self._model, self._data)
        mujoco.mj_collision(self._model, self._data)
        contacts = self._data.contact
        pairs = contacts.geom[contacts.dist < -DEPTH]
        counts = self._is_arm[pairs].any(axis=1)
        counts &= ~self._is_dish[pairs].any(axis=1) & ~self._is_hand[pairs].all(axis=1)
        if but_drawers:
            counts &= ~self._is_drawer[pairs].any(axis=1)
        return bool(counts.any())

    def _within_box(self, held: np.ndarray) -> bool:
        """Whether points in the hand's frame, (K, 3), lie within a board or a wall."""
        hand = self._data.site(PINCH)
        points = held @ hand.xmat.reshape(3, 3).T + hand.xpos
        turns = self._data.geom_xmat[self._boxes].reshape(-1, 3, 3)
        local = np.einsum("bij,bki->bkj", turns, points - self._data.geom_xpos[self._boxes, None])
        sizes = self._model.geom_size[self._boxes, None] + MARGIN
        return bool((np.abs(local) < sizes).all(axis=2).any())


def _within(model: mujoco.MjModel, body: int, root: int) -> bool:
    """Whether a body is another one or hangs on it."""
    while body not in (0, root):
        body = model.body_parentid[body]
    return body == root
