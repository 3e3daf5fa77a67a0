"""One demonstration from pictures to prompt and data set; the slow part is made once."""

import numpy as np
import pytest

pytest.importorskip("gym_hil", reason="needs the extra `robot`")

from kitchen_prefs.instances import CHOSEN, IS_PLACE, POSITION, unpad
from kitchen_prefs.rendering.opengl import NoOpenGLError
from kitchen_prefs_robot.demonstrations.loading import Origin, read_origin, read_prompt
from kitchen_prefs_robot.demonstrations.person import Person
from kitchen_prefs_robot.demonstrations.preferences import HUMAN_PREFERENCES
from kitchen_prefs_robot.demonstrations.recording import record
from kitchen_prefs_robot.demonstrations.storage import REPO_ID, write_demonstrations
from kitchen_prefs_robot.scene import World, sample_scene
from kitchen_prefs_robot.scene.layout import (
    CABINET_POSITION,
    CABINET_ROTATION,
    DRAWER_FLOOR,
    DRAWER_INNER,
)
from kitchen_prefs_robot.task.rows import drop_position

pytestmark = [pytest.mark.xdist_group("robot demonstration"), pytest.mark.slow]

SCENE, PREFERENCE = 3, 0


@pytest.fixture(scope="module")
def shown():
    try:
        return record(SCENE, PREFERENCE)
    except NoOpenGLError:
        pytest.skip("needs EGL")


def test_a_person_puts_each_dish_into_its_drawer_and_closes_both():
    preference = HUMAN_PREFERENCES[1]
    world = World(sample_scene(5, preference.categories))
    person, acts = Person(world, preference), 0
    while not person.has_finished:
        person.act()
        acts += 1
    assert acts == 12
    for number, dish in enumerate(world.scene.dishes):
        x, y, z = CABINET_ROTATION.inv().apply(world.dish_pose(number)[0] - CABINET_POSITION)
        drawer = preference.drawer_of[dish.category]
        assert -DRAWER_INNER[0] < x < 0, dish.category
        assert abs(y) < DRAWER_INNER[1] / 2, dish.category
        assert 0 < z - DRAWER_FLOOR[drawer] < 0.15, dish.category
    assert world.drawer_opening("upper") < 0.01
    assert world.drawer_opening("lower") < 0.01


def test_the_robot_sees_what_the_person_does(shown):
    picked_and_placed = [seen for seen, _ in shown.taken_for if seen]
    assert picked_and_placed[::2] == ["big bowl", "small plate", "cup", "small bowl"]
    assert picked_and_placed[1::2] == picked_and_placed[::2]
    assert shown.misread == ()
    assert len(shown.chosen) == 12


def test_placed_dishes_were_placed_at_the_drop_pose(shown):
    placed = [
        rows[c] for rows, c in zip(shown.sets, shown.chosen, strict=True) if rows[c, IS_PLACE]
    ]
    assert [tuple(row[POSITION]) for row in placed] == [
        pytest.approx(drop_position(drawer)) for drawer in ("upper", "upper", "lower", "lower")
    ]


def test_the_prompt_marks_one_row_a_decision(shown):
    assert shown.prompt.shape == (1664, 14)
    assert shown.prompt[:, CHOSEN].sum() == 12
    assert len(unpad(shown.prompt)) == sum(map(len, shown.sets))


@pytest.mark.lerobot
def test_lerobot_reads_what_was_written(shown, tmp_path):
    from lerobot.datasets import LeRobotDataset

    root = tmp_path / "demonstration"
    write_demonstrations([shown], root)
    dataset = LeRobotDataset(REPO_ID, root=root, video_backend="pyav")
    assert len(dataset) == 12
    frame = dataset[4]
    picture = frame["observation.images.front"].permute(1, 2, 0).numpy()
    assert np.abs(picture - shown.pictures["front"][4] / 255).mean() < 0.03
    assert int(frame["chosen_index"]) == shown.chosen[4]
    assert (read_prompt(root) == shown.prompt).all()
    assert read_origin(root) == Origin(SCENE, PREFERENCE, ())
    with pytest.raises(ValueError, match="no episode 3"):
        read_prompt(root, 3)
    with pytest.raises(ValueError, match="holds something"):
        write_demonstrations([shown], root)


def test_a_recording_that_fails_leaves_nothing(tmp_path):
    def failing():
        raise ValueError("The cameras see no dish.")
        yield

    with pytest.raises(ValueError, match="no dish"):
        write_demonstrations(failing(), tmp_path / "demonstration")
    assert not (tmp_path / "demonstration").exists()


def test_no_data_set_is_one_sentence(tmp_path):
    with pytest.raises(ValueError, match="no data set of demonstrations"):
        read_prompt(tmp_path)
    with pytest.raises(ValueError, match="no data set of demonstrations"):
        read_origin(tmp_path)
