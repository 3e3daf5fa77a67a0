import numpy as np
import pytest
from scipy.spatial.transform import Rotation

pytest.importorskip("fast_simplification", reason="needs the extra `robot`")

from kitchen_prefs_robot.perception.categories import KnownDish, nearest_by_colour
from kitchen_prefs_robot.perception.cloud import Cloud, joined
from kitchen_prefs_robot.perception.clusters import box_round, find_clusters
from kitchen_prefs_robot.perception.detection import join_fragments
from kitchen_prefs_robot.perception.plane import find_plane

RED, BLUE, WHITE = (0.6, 0.1, 0.1), (0.1, 0.2, 0.6), (0.9, 0.9, 0.8)
KNOWN = (
    KnownDish("cup", RED, (0.12, 0.10, 0.10)),
    KnownDish("small bowl", BLUE, (0.14, 0.14, 0.06)),
    KnownDish("small plate", WHITE, (0.18, 0.18, 0.02)),
)


def dish(colour, middle, size=(0.12, 0.12, 0.06)):
    """Points all over a box, 6 mm apart."""
    axes = [np.arange(-extent / 2, extent / 2, 0.006) for extent in size]
    points = np.stack(np.meshgrid(*axes), axis=-1).reshape(-1, 3) + middle
    return Cloud(points, np.tile(colour, (len(points), 1)).astype(float))


def test_the_table_is_found_among_other_things():
    rng = np.random.default_rng(0)
    table = np.column_stack([rng.uniform(0, 1, (3000, 2)), 0.003 * rng.standard_normal(3000)])
    other = rng.uniform(0, 1, (2000, 3))
    plane = find_plane(np.concatenate([table, other]), rng)
    assert plane.normal == pytest.approx((0, 0, 1), abs=0.01)
    assert plane.heights(np.array([[0.5, 0.5, 0.1]])) == pytest.approx([0.1], abs=0.003)


def test_no_points_are_no_table():
    with pytest.raises(ValueError, match="see no table"):
        find_plane(np.zeros((0, 3)), np.random.default_rng(0))


def test_a_box_has_the_turn_and_the_middle_of_what_it_holds():
    points = dish(RED, (0, 0, 0.05), (0.20, 0.10, 0.06)).points
    turned = Rotation.from_euler("z", 0.5).apply(points) + np.array([0.4, -0.2, 0.0])
    box = box_round(turned)
    assert box.middle == pytest.approx((0.4, -0.2, 0.05), abs=0.005)
    assert box.extents == pytest.approx((0.20, 0.10, 0.06), abs=0.008)
    assert box.yaw == pytest.approx(0.5, abs=0.01)


def test_a_box_reaches_down_to_what_its_object_stands_on():
    box = box_round(dish(RED, (0, 0, 0.05)).points, floor=0.0)
    assert box.middle[2] - box.extents[2] / 2 == pytest.approx(0.0)


def test_dishes_apart_are_clusters_and_stray_points_are_not():
    stray = Cloud(np.random.default_rng(0).uniform(1, 2, (30, 3)), np.zeros((30, 3)))
    cloud = joined([dish(RED, (0, 0, 0)), dish(BLUE, (0.3, 0, 0)), stray])
    clusters = find_clusters(cloud, 0.2)
    assert sorted(round(float(c.points[:, 0].mean()), 1) for c in clusters) == [0.0, 0.3]


def test_touching_dishes_are_told_apart_by_their_colours():
    cloud = joined([dish(RED, (0, 0, 0)), dish(BLUE, (0.122, 0, 0))])
    assert len(find_clusters(cloud, 0.2)) == 2
    assert len(find_clusters(joined([dish(RED, (0, 0, 0)), dish(RED, (0.122, 0, 0))]), 0.2)) == 1


def test_no_points_are_no_clusters():
    assert find_clusters(Cloud(np.zeros((0, 3)), np.zeros((0, 3))), 0.2) == []


def test_the_sides_of_one_dish_are_joined():
    sides = [dish(BLUE, (x, 0, 0), (0.02, 0.12, 0.06)) for x in (0.0, 0.1)]
    assert len(join_fragments(sides, KNOWN)) == 1


def test_dishes_of_one_colour_that_are_too_large_together_stay_two():
    assert len(join_fragments([dish(BLUE, (0, 0, 0)), dish(BLUE, (0.15, 0, 0))], KNOWN)) == 2
    sides = [dish(BLUE, (0, 0, 0), (0.02, 0.12, 0.06)), dish(RED, (0.1, 0, 0), (0.02, 0.12, 0.06))]
    assert len(join_fragments(sides, KNOWN)) == 2


@pytest.mark.parametrize("known", KNOWN)
def test_a_colour_belongs_to_the_nearest_known_dish(known):
    assert nearest_by_colour(0.85 * np.array(known.colour), KNOWN) == known


def test_a_strange_colour_belongs_to_none():
    assert nearest_by_colour(np.array((0.2, 0.9, 0.2)), KNOWN) is None
