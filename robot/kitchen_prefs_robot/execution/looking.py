"""One look at the table: which dishes stand where, and which drawer is open."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Protocol, Self

import numpy as np
from scipy.spatial.transform import Rotation

from kitchen_prefs.simulation.layout import COUNTER_HEIGHT, EXTENTS
from kitchen_prefs_robot.execution.conditions import Conditions
from kitchen_prefs_robot.execution.whereabouts import is_on_table
from kitchen_prefs_robot.motion.obstacles import Furniture
from kitchen_prefs_robot.motion.seen_points import exact_points
from kitchen_prefs_robot.perception.cameras import Cameras, displaced_poses
from kitchen_prefs_robot.perception.cloud import Frame
from kitchen_prefs_robot.perception.detection import Detection, Touching, perceive
from kitchen_prefs_robot.perception.known_dishes import known_dishes
from kitchen_prefs_robot.perception.regions import open_drawer
from kitchen_prefs_robot.real_to_sim import measure_counter, to_drawers_state
from kitchen_prefs_robot.scene import World
from kitchen_prefs_robot.scene.layout import DRAWERS
from kitchen_prefs_robot.scene.views import PICTURE_SIZE
from kitchen_prefs_robot.task.state import SeenDish


@dataclass(frozen=True)
class TableDish:
    """A dish on the table.

    Attributes:
        seen: As the task has it, in the kitchen's frame.
        middle: Where it is, (3,) m in the base's frame.
        points: On its surface, (N, 3) m in the base's frame.
        others: Gives the points of all else, (M, 3), which is costly and seldom needed.
    """

    seen: SeenDish
    middle: np.ndarray
    points: np.ndarray
    others: Callable[[], np.ndarray]


@dataclass(frozen=True)
class Look:
    """What one look says.

    Attributes:
        dishes: On the table; those in drawers are remembered, not seen.
        openings: How far each drawer is open, m.
        stands_known: Whether it is known where the stands are; the cameras see points of them.
        frames: The cameras' pictures; none where nothing was looked at.
        detections: What perception made of them.
        touching: What it could not tell apart: the robot leaves these dishes alone.
    """

    dishes: tuple[TableDish, ...]
    openings: Mapping[str, float]
    stands_known: bool = False
    frames: Mapping[str, Frame] = field(default_factory=dict)
    detections: Sequence[Detection] = ()
    touching: Sequence[Touching] = ()

    @property
    def opened(self) -> str | None:
        """The drawer that is open, or None."""
        return open_drawer(self.openings)

    @property
    def furniture(self) -> Furniture:
        """What the arm may know of drawers and stands when it plans."""
        return Furniture(self.openings, self.stands_known)

    def without(self, dish: TableDish) -> Self:
        """The look without the dish that the hand has taken since."""
        return replace(self, dishes=tuple(other for other in self.dishes if other is not dish))

    def with_pictures(self, frames: Mapping[str, Frame]) -> Self:
        """The look with newer pictures, in which nothing was looked for."""
        return replace(self, frames=frames, detections=(), touching=())


NOTHING_SEEN = Look((), dict.fromkeys(DRAWERS, 0.0))


class Eyes(Protocol):
    """Looks at a world."""

    def look(self) -> Look:
        """Look once."""

    def take(self) -> Mapping[str, Frame]:
        """Take pictures alone."""

    def close(self) -> None:
        """Release what looking needs."""


class CameraEyes:
    """Looks with the three cameras, calibrated by the tags.

    Args:
        world: What is looked at.
        conditions: Light is the scene's; the rest of what perception suffers from is here.
        seed: Of all noise.

    Raises:
        NoOpenGLError: If there is no OpenGL library to draw with.
    """

    def __init__(self, world: World, conditions: Conditions, seed: int) -> None:
        poses = displaced_poses(conditions.camera_error, seed)
        categories = tuple(dict.fromkeys(dish.category for dish in world.scene.dishes))
        self._known = known_dishes(categories, conditions.colours)
        self._counter = measure_counter(seed=seed)
        self._cameras = Cameras(world, poses, *PICTURE_SIZE, conditions.depth_noise, seed)
        self._cameras.__enter__()

    def look(self) -> Look:
        """Take three pictures and find the dishes on the counter.

        Raises:
            NotSeenError: If the cameras see no table, or not the front of a drawer.
        """
        frames = self.take()
        sight = perceive(self._cameras.cloud(frames), self._known)
        found = [dish for dish in sight.dishes if dish.place == "counter"]
        state = to_drawers_state(found, sight.openings, self._counter)

        def others_of(dish: Detection) -> Callable[[], np.ndarray]:
            return lambda: sight.obstacles_beside(dish)

        dishes = tuple(
            TableDish(seen, dish.box.middle, dish.cloud.points, others_of(dish))
            for seen, dish in zip(state.dishes, found, strict=True)
        )
        return Look(
            dishes,
            sight.openings,
            frames=frames,
            detections=sight.dishes,
            touching=sight.touching,
        )

    def take(self) -> Mapping[str, Frame]:
        """Take three pictures."""
        return self._cameras.take()

    def close(self) -> None:
        """Release OpenGL."""
        self._cameras.__exit__()


class TrueEyes:
    """Knows what is true; as `CameraEyes`, without pictures."""

    def __init__(self, world: World, seed: int) -> None:
        self._world = world
        self._counter = measure_counter(noise=0.0)
        self._rng = np.random.default_rng([seed, len("truth")])

    def look(self) -> Look:
        """Read the state of the world."""
        world = self._world
        points = exact_points(world, self._rng)
        dishes = tuple(
            self._dish(number, *points[number])
            for number in range(len(world.scene.dishes))
            if is_on_table(world, number)
        )
        return Look(dishes, Furniture.true(world).openings, stands_known=True)

    def take(self) -> Mapping[str, Frame]:
        """Take no pictures."""
        return {}

    def close(self) -> None:
        """Do nothing: there is nothing to release."""

    def _dish(self, number: int, points: np.ndarray, others: np.ndarray) -> TableDish:
        middle, quaternion = self._world.dish_pose(number)
        return TableDish(self._seen(number, middle, quaternion), middle, points, lambda: others)

    def _seen(self, number: int, middle: np.ndarray, quaternion: np.ndarray) -> SeenDish:
        category = self._world.scene.dishes[number].category
        x, y = (float(value) for value in self._counter.to_kitchen(middle[:2]))
        turn = Rotation.from_quat(quaternion, scalar_first=True)
        w, i, j, k = (
            (Rotation.from_euler("z", self._counter.yaw) * turn).as_quat(scalar_first=True).tolist()
        )
        z = COUNTER_HEIGHT + EXTENTS[category][2] / 2
        return SeenDish(category, (x, y, z), (w, i, j, k), None)


def make_eyes(world: World, conditions: Conditions, seed: int) -> Eyes:
    """The eyes that an experiment gives to the robot."""
    if conditions.perception == "truth":
        return TrueEyes(world, seed)
    return CameraEyes(world, conditions, seed)
