"""What is counted of an episode, and what dishes that are not right failed by."""

from dataclasses import replace

import pytest

pytest.importorskip("gym_hil", reason="needs the extra robot")

from kitchen_prefs_robot.demonstrations.preferences import human_preference
from kitchen_prefs_robot.execution.conditions import Conditions
from kitchen_prefs_robot.execution.episode import RobotEpisode
from kitchen_prefs_robot.execution.hands import InvisibleHand
from kitchen_prefs_robot.execution.looking import TrueEyes
from kitchen_prefs_robot.execution.outcomes import outcome_of
from kitchen_prefs_robot.execution.trials import Trial, mean_right
from kitchen_prefs_robot.motion.outcomes import Result
from kitchen_prefs_robot.task.decisions import Pick, Place, Toggle
from kitchen_prefs_robot.task.expert import choose

GIVEN = Conditions(perception="truth", grasps="truth")
WANTED = human_preference(0)  # upper: big bowl, small plate; then lower: cup, small bowl


@pytest.fixture
def episode():
    with RobotEpisode(3, WANTED, GIVEN) as episode:
        yield episode


def number_of(episode, category):
    return next(n for n, dish in enumerate(episode.state.dishes) if dish.category == category)


def put(episode, category, drawer="upper"):
    episode.decide(Pick(number_of(episode, category)))
    episode.decide(Place(drawer))


def follow(episode, preference=WANTED):
    while not (episode.terminated or episode.truncated):
        episode.decide(choose(episode.state, preference))


def fail_to_drop(hand, result):
    """Put what the hand holds back onto the table."""
    dish = hand._world.scene.dishes[hand.held]
    hand._world.set_dish_pose(hand.held, dish.position, (1.0, 0.0, 0.0, 0.0))
    hand.held = None
    return result


def test_a_dish_that_was_dropped_twice_came_where_it_lies_the_last_time(episode, monkeypatch):
    episode.decide(Toggle("upper"))
    with monkeypatch.context() as patch:
        patch.setattr(InvisibleHand, "drop", lambda hand, *_: fail_to_drop(hand, Result.DROPPED))
        put(episode, "big bowl")
    put(episode, "small plate")
    follow(episode)
    outcome = outcome_of(episode)
    assert (outcome.in_drawer, outcome.closed) == (1.0, True)
    assert outcome.right == 0.75


def test_a_drawer_that_stands_out_is_not_closed(episode):
    follow(episode)
    assert outcome_of(episode).closed
    episode.world.set_drawer("lower", 0.03)  # which the robot takes for closed
    assert episode.terminated
    assert not outcome_of(episode).closed


def test_a_dish_that_is_taken_for_another_fails_by_perception(episode, monkeypatch):
    names = {"cup": "small plate", "small plate": "cup"}

    def misread(dish):
        seen = dish.seen
        return replace(dish, seen=replace(seen, category=names.get(seen.category, seen.category)))

    look = TrueEyes.look
    monkeypatch.setattr(
        TrueEyes,
        "look",
        lambda eyes: replace(look(eyes), dishes=tuple(map(misread, look(eyes).dishes))),
    )
    episode.decide(Toggle("upper"))
    follow(episode)
    outcome = outcome_of(episode)
    assert outcome.misread == 2
    assert outcome.causes == {"perception": 2}


def test_a_dish_that_is_not_seen_fails_by_perception(episode, monkeypatch):
    look = TrueEyes.look

    def without_cup(eyes):
        seen = look(eyes)
        return replace(
            seen, dishes=tuple(dish for dish in seen.dishes if dish.seen.category != "cup")
        )

    monkeypatch.setattr(TrueEyes, "look", without_cup)
    episode.decide(Toggle("upper"))
    follow(episode)
    assert outcome_of(episode).causes == {"perception": 1}


def test_a_category_that_was_misread_in_the_demonstration_fails_by_it(episode):
    follow(episode, WANTED.opposite())
    assert outcome_of(episode).causes == {"decision": 4}
    outcome = outcome_of(episode, shown=2, misread=[("cup", "small plate")])
    assert outcome.causes == {"decision": 2, "demonstration": 2}
    assert (outcome.shown, outcome.misread_when_shown) == (2, 1)


def test_a_dish_that_is_still_in_hand_fails_by_decision(episode):
    episode.decide(Toggle("upper"))
    episode.decide(Pick(number_of(episode, "cup")))
    while not episode.truncated:
        episode.decide(Toggle("upper"))  # refused, with a dish in hand
    assert outcome_of(episode).causes == {"decision": 4}


def test_a_dish_that_is_missed_fails_by_grasp_until_it_is_put_away(episode, monkeypatch):
    episode.decide(Toggle("upper"))
    with monkeypatch.context() as patch:
        patch.setattr(InvisibleHand, "pick", lambda *_: Result.MISSED)
        episode.decide(Pick(number_of(episode, "big bowl")))
    outcome = outcome_of(episode)
    assert (outcome.failed_picks, outcome.causes) == (1, {"grasp": 1, "decision": 3})
    put(episode, "big bowl")
    assert outcome_of(episode).causes == {"decision": 3}


def test_a_dish_for_a_drawer_that_is_half_open_fails_by_the_drawer(episode, monkeypatch):
    episode.decide(Toggle("upper"))
    with monkeypatch.context() as patch:
        patch.setattr(InvisibleHand, "drop", lambda hand, *_: fail_to_drop(hand, Result.NOT_OPEN))
        put(episode, "big bowl")
    assert outcome_of(episode).causes == {"drawer": 1, "decision": 3}


def test_dishes_that_wait_for_a_drawer_that_jams_fail_by_it():
    with RobotEpisode(3, WANTED, Conditions(perception="truth")) as episode:
        episode.world.model.joint("lower").range[:] = (0.0, 0.02)
        assert episode.decide(Toggle("lower")).result is Result.JAMMED
        assert episode.state.opened is None
        assert outcome_of(episode).causes == {"drawer": 4}


def test_the_invisible_hand_misses_where_no_dish_is(episode):
    episode.decide(Toggle("upper"))
    cup = number_of(episode, "cup")
    for number, dish in enumerate(episode.world.scene.dishes):
        if dish.category == "cup":
            episode.world.set_dish_pose(number, (0.2, 0.6, 0.05), (1.0, 0.0, 0.0, 0.0))
    step = episode.decide(Pick(cup))
    assert (step.result, step.dish) == (Result.MISSED, None)
    assert episode.state.in_hand is None


def test_a_mean_has_an_interval_over_scenes(episode):
    nothing = outcome_of(episode)
    right = [replace(nothing, right=share) for share in (0.0, 1.0)]
    whole = {Trial(scene, p): right[1] for scene in range(10) for p in range(4)}
    half = {trial: right[trial.scene % 2] for trial in whole}
    assert 0 < mean_right(half).low < 0.3
    assert mean_right(half).mean == 0.5
    assert mean_right(whole).mean == mean_right(whole).high == 1.0
    assert mean_right(whole).low == pytest.approx(0.722, abs=0.001)  # Wilson's of 10 of 10 scenes


@pytest.mark.parametrize(
    ("part", "value"), [("perception", "camera"), ("grasps", "hand"), ("colours", "alik")]
)
def test_conditions_that_there_are_not_are_named(part, value):
    with pytest.raises(ValueError, match=f"There are no {part} '{value}'"):
        Conditions(**{part: value})
