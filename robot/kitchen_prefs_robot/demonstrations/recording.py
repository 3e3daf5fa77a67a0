"""One demonstration: a person acts, the cameras look once a decision, perception does the rest."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from kitchen_prefs_robot.demonstrations.decisions import decision_between
from kitchen_prefs_robot.demonstrations.person import Person
from kitchen_prefs_robot.demonstrations.preferences import human_preference
from kitchen_prefs_robot.perception.cameras import Cameras, displaced_poses
from kitchen_prefs_robot.perception.detection import Sight, perceive
from kitchen_prefs_robot.perception.known_dishes import known_dishes
from kitchen_prefs_robot.real_to_sim import measure_counter, to_drawers_state
from kitchen_prefs_robot.scene import World, sample_scene
from kitchen_prefs_robot.scene.tableware import Colours
from kitchen_prefs_robot.scene.views import PICTURE_SIZE
from kitchen_prefs_robot.task.decisions import Decision, Pick, Place, choices
from kitchen_prefs_robot.task.rows import observe, prompt_of
from kitchen_prefs_robot.task.state import DrawersState


@dataclass(frozen=True)
class HumanDemonstration:
    """A demonstration of T decisions, as the robot saw it.

    Attributes:
        scene: The seed of the scene.
        preference: The number of the preference.
        pictures: What each camera saw before each decision, (T, H, W, 3) uint8.
        sets: The instance set of each decision, (N, 13) each.
        chosen: The row that each decision chose.
        taken_for: The category that the dish of each decision was taken for, and its own; None for
            a drawer.
    """

    scene: int
    preference: int
    pictures: dict[str, np.ndarray]
    sets: tuple[np.ndarray, ...]
    chosen: tuple[int, ...]
    taken_for: tuple[tuple[str | None, str | None], ...]

    @property
    def prompt(self) -> np.ndarray:
        """The demonstration as a policy reads it, (1664, 14) float32."""
        return prompt_of(self.sets, self.chosen)

    @property
    def misread(self) -> tuple[tuple[str, str], ...]:
        """Own category, and the one that it was taken for, of dishes that were misread."""
        mistakes = {(own, seen) for seen, own in self.taken_for if own and seen and own != seen}
        return tuple(sorted(mistakes))


def record(
    scene: int,
    preference: int,
    colours: Colours = "distinct",
    lamp: float = 0.0,
    depth_noise: float = 1.0,
    camera_error: float = 0.0,
) -> HumanDemonstration:
    """Let a person demonstrate a preference, and look before each decision and after the last.

    Args:
        scene: The seed of the scene.
        preference: The number of the preference, see `preferences`.
        colours: Of the dishes, "distinct" or "alike".
        lamp: How much the light changes at most, as a share of its brightness.
        depth_noise: Multiplies the depth's error.
        camera_error: m by which each camera's estimated position is off, standard deviation of each
            coordinate.

    Raises:
        NoOpenGLError: If there is no OpenGL library to draw with.
        ValueError: If there is no such preference, or if what the cameras see is no demonstration:
            no dish, dishes that touch, or a change that is no single decision.
    """
    shown = human_preference(preference)
    known = known_dishes(shown.categories, colours)
    world = World(sample_scene(scene, shown.categories, colours, lamp))
    person, sights, pictures, held = Person(world, shown), [], [], []
    poses = displaced_poses(camera_error, scene)
    with Cameras(world, poses, *PICTURE_SIZE, depth_noise, scene) as cameras:
        while True:
            frames = cameras.take()
            sights.append(perceive(cameras.cloud(frames), known))
            _check(sights, scene)
            if person.has_finished:
                break
            pictures.append({camera: frame.colour for camera, frame in frames.items()})
            held.append(person.holds)
            person.act()
    states, decisions = _understand(sights, scene)
    sets = tuple(observe(state, step) for step, state in enumerate(states))
    pairs = list(zip(states, decisions, strict=True))
    chosen = tuple(choices(state).index(decision) for state, decision in pairs)
    taken_for = tuple(_taken_for(*pair, held[step:]) for step, pair in enumerate(pairs))
    by_camera = {camera: np.stack([p[camera] for p in pictures]) for camera in world.cameras}
    return HumanDemonstration(scene, preference, by_camera, sets, chosen, taken_for)


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


def _understand(sights: list[Sight], scene: int) -> tuple[list[DrawersState], list[Decision]]:
    """What was known before each decision, and the decision."""
    counter = measure_counter(seed=scene)
    states, decisions = [], []
    for step, (before, after) in enumerate(pairwise(sights)):
        states.append(to_drawers_state(before.dishes, before.openings, counter))
        try:
            decisions.append(decision_between(before, after))
        except ValueError as error:
            raise ValueError(
                f"Looks {step + 1} and {step + 2} of the demonstration in scene {scene} cannot be "
                f"understood: {error}."
            ) from error
    return states, decisions


def _taken_for(
    state: DrawersState, decision: Decision, held: Sequence[str | None]
) -> tuple[str | None, str | None]:
    """The category that the dish of a decision is taken for, and its own.

    Args:
        state: What was known before the decision.
        decision: The decision.
        held: The category in the person's hand, before the decision and before each after it.
    """
    if isinstance(decision, Pick):
        return state.dishes[decision.dish].category, held[1]
    if isinstance(decision, Place):
        return state.in_hand, held[0]
    return None, None
