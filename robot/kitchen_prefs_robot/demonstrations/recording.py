"""One demonstration: a person acts, the cameras look once a decision, perception does the rest."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from kitchen_prefs_robot.demonstrations.decisions import decision_between
from kitchen_prefs_robot.demonstrations.person import Person
from kitchen_prefs_robot.demonstrations.preferences import human_preference
from kitchen_prefs_robot.perception.cameras import Cameras, laboratory_poses
from kitchen_prefs_robot.perception.detection import Sight, perceive
from kitchen_prefs_robot.perception.known_dishes import known_dishes
from kitchen_prefs_robot.real_to_sim import measure_work_areas, to_drawers_state
from kitchen_prefs_robot.scene import World, sample_scene
from kitchen_prefs_robot.scene.tableware import Colours
from kitchen_prefs_robot.scene.views import PICTURE_SIZE
from kitchen_prefs_robot.task.decisions import choices
from kitchen_prefs_robot.task.rows import observe, prompt_of


@dataclass(frozen=True)
class HumanDemonstration:
    """A demonstration of T decisions, as the robot saw it.

    Attributes:
        scene: The seed of the scene.
        preference: The number of the preference.
        pictures: What each camera saw before each decision, (T, H, W, 3) uint8.
        sets: The instance set of each decision, (N, 13) each.
        chosen: The row that each decision chose.
        in_hand: The category of the dish in hand as it was seen, and as it was, at each decision.
    """

    scene: int
    preference: int
    pictures: dict[str, np.ndarray]
    sets: tuple[np.ndarray, ...]
    chosen: tuple[int, ...]
    in_hand: tuple[tuple[str | None, str | None], ...]

    @property
    def prompt(self) -> np.ndarray:
        """The demonstration as a policy reads it, (1664, 14) float32."""
        return prompt_of(self.sets, self.chosen)

    @property
    def misread(self) -> int:
        """How many dishes were taken for another category while they were in hand."""
        return sum(seen != true for seen, true in self.in_hand)


def record(
    scene: int,
    preference: int,
    colours: Colours = "distinct",
    lamp: float = 0.0,
    depth_noise: float = 1.0,
) -> HumanDemonstration:
    """Let a person demonstrate a preference, and look before each decision and after the last.

    Args:
        scene: The seed of the scene.
        preference: The number of the preference, see `preferences`.
        colours: Of the dishes, "distinct" or "alike".
        lamp: How much the light changes at most, as a share of its brightness.
        depth_noise: Multiplies the depth's error.

    Raises:
        NoOpenGLError: If there is no OpenGL library to draw with.
        ValueError: If there is no such preference, or if what the cameras see is no demonstration:
            no dish, dishes that touch, or a change that is no single decision.
    """
    shown = human_preference(preference)
    known = known_dishes(shown.categories, colours)
    world = World(sample_scene(scene, shown.categories, colours, lamp))
    person, sights, pictures, held = Person(world, shown), [], [], []
    with Cameras(world, laboratory_poses(), *PICTURE_SIZE, depth_noise, scene) as cameras:
        while True:
            frames = cameras.take()
            sights.append(perceive(cameras.cloud(frames), known))
            _check(sights, scene)
            if person.has_finished:
                break
            pictures.append({camera: frame.colour for camera, frame in frames.items()})
            held.append(person.holds)
            person.act()
    sets, chosen, seen = _understand(sights, scene)
    by_camera = {camera: np.stack([p[camera] for p in pictures]) for camera in world.cameras}
    in_hand = tuple(zip(seen, held, strict=True))
    return HumanDemonstration(scene, preference, by_camera, sets, chosen, in_hand)


def _check(sights: list[Sight], scene: int) -> None:
    """Refuse a look that cannot be understood."""
    if len(sights) == 1 and not sights[0].dishes:
        raise ValueError(
            f"The cameras see no dish in scene {scene}; lay dishes on the counter, or clear the "
            "cameras' view."
        )
    for touching in sights[-1].touching:
        if touching.place == "counter":
            raise ValueError(f"Scene {scene}, look {len(sights)}: {touching.sentence}")


def _understand(
    sights: list[Sight], scene: int
) -> tuple[tuple[np.ndarray, ...], tuple[int, ...], list[str | None]]:
    """The instance set, the chosen row and the category in hand of each decision."""
    areas = measure_work_areas(seed=scene)
    sets, chosen, in_hand = [], [], []
    for step, (before, after) in enumerate(pairwise(sights)):
        state = to_drawers_state(before.dishes, before.openings, areas)
        try:
            decision = decision_between(before, after)
        except ValueError as error:
            raise ValueError(
                f"Looks {step + 1} and {step + 2} of the demonstration in scene {scene} cannot be "
                f"understood: {error}."
            ) from error
        sets.append(observe(state, step))
        chosen.append(choices(state).index(decision))
        in_hand.append(state.in_hand)
    return tuple(sets), tuple(chosen), in_hand
