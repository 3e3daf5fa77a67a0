"""The expert's demonstrations: replayed by their actions alone, each loads all dishes rightly."""

from kitchen_prefs.instances import CHOSEN, COLUMNS, DECISION, POSE
from kitchen_prefs.metrics import edit_similarity, packing_efficiency, success
from kitchen_prefs_robot.task.dataset import SESSIONS, as_recorded
from kitchen_prefs_robot.task.demonstrations import demonstrate
from kitchen_prefs_robot.task.metrics import episode_of, right_dishes
from kitchen_prefs_robot.task.rows import chosen_decision, observe
from kitchen_prefs_robot.task.sessions import make_session, prompt_session
from kitchen_prefs_robot.task.simulator import DrawersSimulator


def test_every_demonstration_of_a_sample_is_replayed_to_a_perfect_score():
    for index in range(0, SESSIONS, 9):
        session = make_session("train", index)
        simulator = DrawersSimulator(session)
        for action in as_recorded(session).action:
            rows = observe(simulator.seen, len(simulator.decisions))
            assert not simulator.decide(chosen_decision(simulator.seen, rows, action))
        episode = episode_of(simulator)
        assert right_dishes(episode) == packing_efficiency(episode) == 1
        assert edit_similarity(episode) == 1
        assert success(episode)


def test_a_prompt_shows_the_same_categories_and_preference_in_another_session():
    session = make_session("test", 3)
    prompt = prompt_session(session)
    assert prompt.preference == session.preference
    assert prompt.start != session.start
    assert {d.category for d in prompt.start.dishes} == {d.category for d in session.start.dishes}
    assert prompt_session(session, opposite=True).preference == session.preference.opposite()
    assert prompt_session(session, opposite=True).start == prompt.start


def test_the_prompt_marks_the_rows_of_the_actions():
    session = make_session("test", 5)
    prompt, recorded = demonstrate(session).prompt, as_recorded(session)
    chosen = prompt[prompt[:, CHOSEN] > 0]
    assert (chosen[:, POSE] == recorded.action).all()
    assert (chosen[:, DECISION] == range(12)).all()
    sets = recorded.instances[range(12), recorded.chosen_index]
    assert (chosen[:, :COLUMNS] == sets).all()
