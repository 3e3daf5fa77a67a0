"""Where dishes come to rest in a rack: drop one at random, let it settle, see if it stands well.

One dish falls into one fixed rack. A pose is rejected when the dish has toppled, still moves, rocks
when the rack is tilted, sticks out of the rack, or is too tall for the rack to close.
"""

from collections.abc import Iterator

import mujoco
import numpy as np
from scipy.spatial.transform import Rotation

from kitchen_prefs.physics.dish_bodies import add_solids
from kitchen_prefs.physics.rack import add_wires
from kitchen_prefs.physics.shapes import hull_points
from kitchen_prefs.simulation.layout import RACK_HEADROOM, RACK_INNER

TIMESTEP = 0.002  # s
GRAVITY = 9.81  # m/s²
LONGEST_FALL = 3.0  # s of simulated time; a dish that moves longer has not found its place
AT_REST = 0.003  # m/s and, tenfold, rad/s: slower than this for CALM is rest
CALM = 0.1  # s
CLEARANCE = 0.005  # m above the highest obstacle, from where a dish falls
TILT = np.deg2rad(5.0)  # four times the push of a rack that slides in within 4 s
TILT_TIME = 0.3  # s in each of four directions
SLACK = (0.01, np.deg2rad(5.0))  # m, rad that a dish may move under the tilt

BEYOND = 0.002  # m over the rack's inner edge: the wall's wires give as much
BELOW = 0.02  # m that a rim may dip between the floor's wires

# How far the dish's own axis may lean, in radians. Cups and glasses stand on their rims, bowls lean
# on tines and walls; the axes of plates and trays lie level.
INVERTED_LEAN = {"cup": 0.25, "glass": 0.25, "small bowl": 1.1, "big bowl": 1.1}
LEVEL_LEAN = {"tray": 0.25, "small plate": 0.40, "big plate": 0.40}


class Settler:
    """One rack and one dish of a category.

    Args:
        category: One of `kitchen_prefs.preferences.CATEGORIES`.
        scale: By how much the dish is larger than its category's extents.
    """

    def __init__(self, category: str, scale: float = 1.0) -> None:
        self.category = category
        self._points = hull_points(category, scale)  # (n, 3)
        self.model = rack_and_dish(category, scale)
        self.data = mujoco.MjData(self.model)

    def settled(self, rng: np.random.Generator) -> Iterator[np.ndarray]:
        """Drop without end; yield the poses of rest, (7,) in the rack's frame, that stand well."""
        while True:
            pose = self.settle(self._random_pose(rng))
            if pose is not None:
                yield pose

    def settle(self, pose: np.ndarray) -> np.ndarray | None:
        """Let the dish fall from a pose.

        Args:
            pose: Position and quaternion (wxyz) in the rack's frame, (7,).

        Returns:
            The pose of rest, (7,), or None where it does not stand well.
        """
        mujoco.mj_resetData(self.model, self.data)
        self.data.qpos[:] = pose
        if not self._come_to_rest() or not self._stands_well():
            return None
        rest = self.data.qpos.copy()
        return None if self._rocks(rest) else rest

    def _random_pose(self, rng: np.random.Generator) -> np.ndarray:
        turn = _random_turn(self.category, rng)
        points = turn.apply(self._points)
        room = (np.array(RACK_INNER) - np.ptp(points[:, :2], axis=0)) / 2
        x, y = rng.uniform(-1.0, 1.0, 2) * np.maximum(room, 0.0)
        pose = np.array([x, y, -points[:, 2].min(), *turn.as_quat(scalar_first=True)])
        self.data.qpos[:] = pose
        while self._penetrates():
            self.data.qpos[2] += CLEARANCE
        self.data.qpos[2] += CLEARANCE
        return self.data.qpos.copy()

    def _penetrates(self) -> bool:
        mujoco.mj_kinematics(self.model, self.data)
        mujoco.mj_comPos(self.model, self.data)
        mujoco.mj_collision(self.model, self.data)
        return self.data.ncon > 0

    def _come_to_rest(self) -> bool:
        calm = 0.0
        while self.data.time < LONGEST_FALL:
            mujoco.mj_step(self.model, self.data)
            speed = np.abs(self.data.qvel)
            still = speed[:3].max() < AT_REST and speed[3:].max() < 10 * AT_REST
            calm = calm + TIMESTEP if still else 0.0
            if calm >= CALM:
                return True
        return False

    def _stands_well(self) -> bool:
        turn = Rotation.from_quat(self.data.qpos[3:], scalar_first=True)
        return _leans_little(self.category, turn) and _fits(
            turn.apply(self._points) + self.data.qpos[:3]
        )

    def _rocks(self, rest: np.ndarray) -> bool:
        for direction in ((1, 0), (0, 1), (-1, 0), (0, -1)):
            self.model.opt.gravity[:2] = GRAVITY * np.sin(TILT) * np.array(direction)
            mujoco.mj_step(self.model, self.data, round(TILT_TIME / TIMESTEP))
        self.model.opt.gravity[:2] = 0.0
        shift, turn = displacement(rest, self.data.qpos)
        return bool(shift > SLACK[0] or turn > SLACK[1])


def displacement(before: np.ndarray, after: np.ndarray) -> tuple[float, float]:
    """How far a pose, (7,), has moved: metres and radians."""
    first, last = (Rotation.from_quat(pose[3:], scalar_first=True) for pose in (before, after))
    return float(np.linalg.norm(after[:3] - before[:3])), float((last * first.inv()).magnitude())


def physics() -> mujoco.MjSpec:
    """An empty world with the physics that every check of the placements shares."""
    spec = mujoco.MjSpec()
    spec.compiler.degree = False
    spec.option.timestep = TIMESTEP
    spec.option.gravity = (0.0, 0.0, -GRAVITY)
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    spec.option.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
    spec.option.impratio = 10  # friction that does not creep
    return spec


def rack_and_dish(category: str, scale: float = 1.0) -> mujoco.MjModel:
    """One fixed rack and one free dish."""
    spec = physics()
    add_wires(spec.worldbody.add_body(name="rack"))
    dish = spec.worldbody.add_body(name="dish")
    dish.add_freejoint()
    add_solids(dish, category, scale)
    return spec.compile()


def _random_turn(category: str, rng: np.random.Generator) -> Rotation:
    """A rotation near to how the category stands in a rack: upside down, or on its side."""
    spin = rng.uniform(-np.pi, np.pi)
    lean = rng.normal(0.0, 0.05)
    if category in ("cup", "glass"):
        return Rotation.from_euler("xz", [np.pi, spin])
    if category.endswith("bowl"):
        return Rotation.from_euler("zxz", [spin, np.pi - rng.uniform(), rng.choice((0.0, np.pi))])
    side = rng.choice((-0.5, 0.5)) * np.pi
    spin = rng.choice(4) * np.pi / 2 if category == "tray" else spin
    return Rotation.from_euler("zx", [spin, side + lean])


def _leans_little(category: str, turn: Rotation) -> bool:
    upright = float(np.clip(turn.as_matrix()[2, 2], -1.0, 1.0))
    if category in INVERTED_LEAN:
        return bool(np.pi - np.arccos(upright) < INVERTED_LEAN[category])
    return bool(abs(np.arcsin(upright)) < LEVEL_LEAN[category])


def _fits(points: np.ndarray) -> bool:
    """Whether a dish with these outermost points, (n, 3), lets the rack close."""
    reach = np.abs(points[:, :2]).max(axis=0)
    within = (reach <= np.array(RACK_INNER) / 2 + BEYOND).all()
    return bool(within and points[:, 2].min() > -BELOW and points[:, 2].max() <= RACK_HEADROOM)
