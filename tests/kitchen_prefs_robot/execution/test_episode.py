"""Episodes of the robot: what is given as truth never fails, what is real is done by the arm."""

import pytest

pytest.importorskip("gym_hil", reason="needs the extra robot")

from kitchen_prefs_robot.demonstrations.preferences import human_preference
from kitchen_prefs_robot.execution.conditions import Conditions
from kitchen_prefs_robot.execution.episode import RobotEpisode
from kitchen_prefs_robot.execution.looking import NOTHING_SEEN, TrueEyes
from kitchen_prefs_robot.execution.outcomes import outcome_of
from kitchen_prefs_robot.execution.whereabouts import drawer_of
from kitchen_prefs_robot.motion.outcomes import Result
from kitchen_prefs_robot.perception.not_seen import NotSeenError
from kitchen_prefs_robot.task.decisions import Pick, Place, Toggle
from kitchen_prefs_robot.task.expert import choose

GIVEN = Conditions(perception="truth", grasps="truth")


def follow_expert(episode, preference=None):
    """Load a scene by what the robot sees, as its preference or another says."""
    while not (episode.terminated or episode.truncated):
        episode.decide(choose(episode.state, preference or episode.preference))


@pytest.mark.parametrize("preference", range(4))
def test_the_expert_is_right_where_all_is_given(preference):
    with RobotEpisode(3, human_preference(preference), GIVEN) as episode:
        follow_expert(episode)
        outcome = outcome_of(episode)
    assert (outcome.right, outcome.in_drawer, outcome.closed) == (1.0, 1.0, True)
    assert (outcome.decisions, outcome.refused, outcome.failed_picks) == (12, 0, 0)
    assert outcome.causes == {}


def test_another_preference_is_wrong_by_decision():
    with RobotEpisode(3, human_preference(0), GIVEN) as episode:
        follow_expert(episode, human_preference(0).opposite())
        outcome = outcome_of(episode)
    assert (outcome.right, outcome.in_drawer) == (0.0, 0.0)
    assert outcome.closed
    assert outcome.causes == {"decision": 4}


def test_what_the_rules_forbid_moves_nothing():
    with RobotEpisode(3, human_preference(0), GIVEN) as episode:
        before = [episode.world.dish_pose(n)[0].tolist() for n in range(4)]
        step = episode.decide(Pick(0))
        assert step.refusal == "A dish is picked only for an open drawer, and both are closed."
        assert step.result is None
        assert [episode.world.dish_pose(n)[0].tolist() for n in range(4)] == before
        for _ in range(episode.limit - 1):
            episode.decide(Pick(0))
        assert episode.truncated
        outcome = outcome_of(episode)
    assert (outcome.right, outcome.refused) == (0.0, 24)
    assert outcome.causes == {"decision": 4}


def test_a_dish_in_hand_is_known_and_a_dropped_one_remembered():
    with RobotEpisode(3, human_preference(0), GIVEN) as episode:
        episode.decide(Toggle("lower"))
        category = episode.state.dishes[1].category
        step = episode.decide(Pick(1))
        assert episode.state.in_hand == step.seen_as == category
        assert len(episode.state.dishes) == 3
        episode.decide(Place("lower"))
        assert episode.state.in_hand is None
        assert [d.category for d in episode.state.dishes if d.drawer == "lower"] == [category]
        assert drawer_of(episode.world, step.dish) == "lower"
        episode.decide(Toggle("lower"))
        assert drawer_of(episode.world, step.dish) == "lower"  # it has moved with the drawer


@pytest.mark.slow
def test_the_robot_loads_a_scene_that_it_sees_with_its_arm():
    with RobotEpisode(7, human_preference(1)) as episode:
        follow_expert(episode)
        outcome = outcome_of(episode)
    assert outcome.right == outcome.in_drawer == 1.0
    assert outcome.closed
    assert 30 < outcome.seconds < 240
    assert {step.result for step in episode.steps} == {Result.DONE}


@pytest.mark.slow
def test_a_pick_that_is_led_astray_is_seen_and_tried_again():
    conditions = Conditions(perception="truth", grasp_failures=1.0)
    with RobotEpisode(7, human_preference(1), conditions) as episode:
        episode.decide(choose(episode.state, episode.preference))
        steps = [episode.decide(Pick(1)) for _ in range(3)]
        assert any(step.failed for step in steps)
        assert len(episode.look.dishes) + (episode.state.in_hand is not None) == 4
        assert outcome_of(episode).failed_picks == sum(step.failed for step in steps)


def test_a_drawer_is_open_or_closed_and_the_other_waits():
    with RobotEpisode(3, human_preference(0), GIVEN) as episode:
        episode.decide(Toggle("upper"))
        refused = episode.decide(Toggle("lower"))
        assert (refused.refusal != "", refused.result) == (True, None)
        assert episode.state.opened == "upper"
        assert episode.decide(Toggle("upper")).result is Result.DONE  # open already: it closes
        assert episode.state.opened is None


class Failing:
    """Looks with an error, and remembers that it was closed."""

    closed = False

    def __init__(self, error):
        self.error = error

    def look(self):
        raise self.error

    def close(self):
        self.closed = True


def test_an_episode_without_a_view_ends_by_perception(monkeypatch):
    eyes = Failing(NotSeenError("The cameras see no table."))
    monkeypatch.setattr("kitchen_prefs_robot.execution.episode.make_eyes", lambda *_: eyes)
    with RobotEpisode(3, human_preference(0), GIVEN) as episode:
        assert episode.truncated
        assert not episode.terminated
        outcome = outcome_of(episode)
    assert (outcome.blind, outcome.causes) == ("The cameras see no table.", {"perception": 4})
    assert eyes.closed


def test_a_look_that_fails_later_ends_the_episode_where_it_is(monkeypatch):
    with RobotEpisode(3, human_preference(0), GIVEN) as episode:
        monkeypatch.setattr(TrueEyes, "look", Failing(NotSeenError("No front.")).look)
        step = episode.decide(Toggle("upper"))
        assert step.result is Result.DONE
        assert episode.truncated


def test_a_scene_without_a_dish_is_one_sentence(monkeypatch):
    monkeypatch.setattr(TrueEyes, "look", lambda _: NOTHING_SEEN)
    with RobotEpisode(3, human_preference(0), GIVEN) as episode:
        assert episode.blind == "The cameras see no dish in scene 3; clear the view."
        assert outcome_of(episode).causes == {"perception": 4}


def test_the_cameras_are_released_when_the_first_look_fails(monkeypatch):
    eyes = Failing(RuntimeError())
    monkeypatch.setattr("kitchen_prefs_robot.execution.episode.make_eyes", lambda *_: eyes)
    with pytest.raises(RuntimeError):
        RobotEpisode(3, human_preference(0), GIVEN)
    assert eyes.closed
