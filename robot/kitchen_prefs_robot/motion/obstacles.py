"""Whether the arm, on a planned path, would strike itself, the table, the cabinet or a stand.

The table's and the cabinet's places are known, as on a real robot. How far drawers are open, and
where stands and dishes are, only the cameras can tell: openings are given; dishes, and stands whose
places are not known, are left out, as a grasp keeps clear of the points that are seen of them.
"""

from collections.abc import Mapping
from copy import copy
from dataclasses import dataclass
from typing import Self

import mujoco
import numpy as np

from kitchen_prefs_robot.scene import World
from kitchen_prefs_robot.scene.arm import ARM_BODY, ARM_JOINTS, PINCH
from kitchen_prefs_robot.scene.layout import DRAWERS
from kitchen_prefs_robot.scene.model import dish_body, stand_geom

EVERY = 5  # commands from one check to the next: a tenth of a second
MARGIN = 0.01  # m between what the hand holds and furniture: it was seen with errors
DEPTH = 0.002  # m that two parts may overlap


@dataclass(frozen=True)
class Furniture:
    """What is known of the furniture that is not always in one place.

    Attributes:
        openings: How far each drawer is open, m.
        stands: Whether it is known where the stands are; to the cameras they are points among
            others.
    """

    openings: Mapping[str, float]
    stands: bool

    @classmethod
    def true(cls, world: World) -> Self:
        """All of it as it truly is."""
        return cls({drawer: world.drawer_opening(drawer) for drawer in DRAWERS}, stands=True)


class Obstacles:
    """The furniture of a world, as far as it is known, in a copy of the model for planning.

    Args:
        world: Of which the model is copied, and where the arm is.
        furniture: What is known of drawers and stands.
    """

    def __init__(self, world: World, furniture: Furniture) -> None:
        self._model = copy(world.model)
        self._ignore_what_is_not_known(world, furniture)
        self._data = mujoco.MjData(self._model)
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
        of_arm = [_within(self._model, body, root) for body in self._model.jnt_bodyid]
        measured = self._model.jnt_qposadr[of_arm]  # the arm feels its own joints
        self._data.qpos[measured] = world.data.qpos[measured]
        for drawer, opening in furniture.openings.items():
            self._data.joint(drawer).qpos[0] = opening

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

    def _ignore_what_is_not_known(self, world: World, furniture: Furniture) -> None:
        """Let nothing collide with the dishes, nor with stands of which the place is not known."""
        model, ignored = self._model, np.zeros(self._model.ngeom, dtype=bool)
        for number, dish in enumerate(world.scene.dishes):
            ignored |= model.geom_bodyid == model.body(dish_body(number)).id
            if dish.on_stand and not furniture.stands:
                ignored[model.geom(stand_geom(number)).id] = True
        model.geom_contype[ignored] = model.geom_conaffinity[ignored] = 0

    def _arm_strikes(self, joints: np.ndarray, but_drawers: bool) -> bool:
        self._data.qpos[self._joints] = joints
        mujoco.mj_kinematics(self._model, self._data)
        mujoco.mj_comPos(self._model, self._data)
        mujoco.mj_collision(self._model, self._data)
        contacts = self._data.contact
        pairs = contacts.geom[contacts.dist < -DEPTH]
        counts = self._is_arm[pairs].any(axis=1) & ~self._is_hand[pairs].all(axis=1)
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
