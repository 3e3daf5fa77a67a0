"""Rendered scenes: what the cameras' pictures are taken for."""

import numpy as np
import pytest

pytest.importorskip("gym_hil", reason="needs the extra `robot`")

from PIL import Image
from typer.testing import CliRunner

from kitchen_prefs.rendering.opengl import NoOpenGLError
from kitchen_prefs_robot.commands import app
from kitchen_prefs_robot.perception.calibration import pose_error
from kitchen_prefs_robot.perception.cameras import Cameras, calibrate, laboratory_poses
from kitchen_prefs_robot.perception.detection import perceive
from kitchen_prefs_robot.perception.known_dishes import known_dishes
from kitchen_prefs_robot.perception.pictures import beside_clusters
from kitchen_prefs_robot.perception.regions import HAND
from kitchen_prefs_robot.perception.trials import confusion, run_trial
from kitchen_prefs_robot.scene import PAPER_DISHES, World, sample_scene
from kitchen_prefs_robot.scene.layout import DRAWER_FLOOR, from_cabinet
from kitchen_prefs_robot.scene.tableware import real_extents

pytestmark = pytest.mark.xdist_group("robot perception")

UPRIGHT = np.array([1.0, 0.0, 0.0, 0.0])


@pytest.fixture(scope="module")
def poses():
    try:
        return laboratory_poses()
    except NoOpenGLError:
        pytest.skip("needs EGL")


@pytest.fixture
def world(poses):
    return World(sample_scene(3))


def look(world, poses, colours="distinct"):
    with Cameras(world, poses, 320, 240) as cameras:
        frames = cameras.take()
        return frames, perceive(cameras.cloud(frames), known_dishes(colours=colours))


def place(world, number, x, y):
    height = real_extents(world.scene.dishes[number].category)[2] / 2
    world.set_dish_pose(number, np.array([x, y, height]), UPRIGHT)


def test_the_tags_say_where_the_cameras_stand(world, poses):
    for camera in world.cameras:
        true = np.eye(4)
        true[:3, 3], true[:3, :3] = world.camera_pose(camera)
        metres, radians = pose_error(poses[camera], true)
        assert metres < 0.003
        assert np.rad2deg(radians) < 0.2


def test_all_dishes_are_found_where_they_stand(world, poses):
    frames, sight = look(world, poses)
    assert sorted(dish.category for dish in sight.dishes) == sorted(PAPER_DISHES)
    for dish in sight.dishes:
        true = world.dish_pose(PAPER_DISHES.index(dish.category))[0]
        assert np.linalg.norm(dish.box.middle[:2] - true[:2]) < 0.025, dish.category
        assert abs(dish.box.middle[2] - true[2]) < 0.015, dish.category
    assert sight.opened is None
    assert sight.touching == ()
    picture = beside_clusters(frames["front"], poses["front"], sight.dishes)
    tinted = np.ptp(picture[:, 320:].astype(int), axis=2) > 60
    assert picture.shape == (240, 640, 3)
    assert 0.02 < tinted.mean() < 0.2
    bowl = np.argmax(frames["front"].colour[..., 2].astype(int) - frames["front"].colour[..., 0])
    assert tinted.ravel()[bowl]


def test_a_dish_in_hand_one_in_a_drawer_and_the_opening_are_seen(world, poses):
    world.set_drawer("lower", 0.28)
    world.set_dish_pose(
        0, from_cabinet(np.array([0.15, 0.0, DRAWER_FLOOR["lower"] + 0.03])), UPRIGHT
    )
    world.set_dish_pose(2, np.array(HAND), UPRIGHT)
    _, sight = look(world, poses)
    places = {dish.category: dish.place for dish in sight.dishes}
    assert places["small bowl"] == "lower"
    assert places["cup"] == "hand"
    assert places["big bowl"] == places["small plate"] == "counter"
    assert sight.opened == "lower"
    assert sight.openings["lower"] == pytest.approx(0.28, abs=0.006)
    assert sight.openings["upper"] == pytest.approx(0.0, abs=0.006)


def test_touching_dishes_are_told_apart_by_their_colours(world, poses):
    place(world, 0, 0.45, -0.33)
    place(world, 1, 0.45, -0.185)
    _, sight = look(world, poses)
    assert sorted(dish.category for dish in sight.dishes) == sorted(PAPER_DISHES)
    assert sight.touching == ()


def test_touching_dishes_of_one_colour_are_reported(poses):
    world, known = World(sample_scene(3, ("cup", "cup"))), known_dishes(("cup",))
    for number in range(2):
        place(world, number, 0.45, -0.30 + 0.09 * number)
    with Cameras(world, poses, 320, 240) as cameras:
        sight = perceive(cameras.cloud(cameras.take()), known)
    assert sight.dishes == ()
    assert "move them apart" in sight.touching[0].sentence


def test_no_dish_is_no_detection(poses):
    _, sight = look(World(sample_scene(3, dishes=())), poses)
    assert sight.dishes == ()


def test_obstacles_beside_a_dish_are_the_others_and_the_stand(world, poses):
    _, sight = look(world, poses)
    plate = next(dish for dish in sight.dishes if dish.category == "small plate")
    below = sight.obstacles_beside(plate)
    stand = np.linalg.norm(below[:, :2] - plate.box.middle[:2], axis=1) < 0.05
    assert stand.sum() > 100
    assert len(below) < len(sight.obstacles)


def test_a_trial_counts_what_was_found(poses):
    trial = run_trial(11, known_dishes())
    assert trial.is_right
    assert confusion([trial]) == {(category, category): 1 for category in PAPER_DISHES}
    assert np.abs(trial.opening_error) < 0.01
    assert trial.camera_errors.shape == (3, 2)


def test_the_command_prints_a_confusion_matrix_and_saves_a_picture(poses, tmp_path):
    path = tmp_path / "clusters.png"
    result = CliRunner().invoke(
        app, ["perception", "--scenes=1", "--first=11", "--lamp=0", f"--picture={path}"]
    )
    assert result.exit_code == 0, result.output
    assert "Scenes without any mistake: 1 of 1" in result.output
    assert np.asarray(Image.open(path)).shape == (3 * 240, 2 * 320, 3)


def test_without_opengl_it_is_one_sentence(monkeypatch):
    def nothing(*_):
        raise NoOpenGLError

    monkeypatch.setattr("kitchen_prefs_robot.scene.pictures.open_context", nothing)
    with pytest.raises(NoOpenGLError, match="apt install"):
        calibrate(World(sample_scene(0)))


def test_without_the_robots_packages_it_is_one_sentence(monkeypatch):
    monkeypatch.setattr("kitchen_prefs_robot.commands.find_spec", lambda _: None)
    said = str(CliRunner().invoke(app, ["run", "--policy.path=x", "--scene=3"]).exception)
    assert "pip install 'lerobot_policy_kitchen_prefs[robot]'" in said
    assert "\n" not in said
