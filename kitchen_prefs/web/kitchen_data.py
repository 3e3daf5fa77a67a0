"""The kitchen and its sessions, as numbers that are short in JSON; kitchen.js has the rules.

A dish is seen from above. It is drawn as the projection of an ellipsoid of its extents: an ellipse
with a centre, two half axes and an angle; lengths are in millimetres, angles in degrees.
"""

import base64
from collections.abc import Iterable
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from kitchen_prefs.preferences import CATEGORIES
from kitchen_prefs.simulation import layout
from kitchen_prefs.simulation.kitchen import placement_table, rack_position
from kitchen_prefs.simulation.sessions import (
    Session,
    expert_trajectory,
    make_session,
    preference_with,
)
from kitchen_prefs.splits import get_split

MILLIMETRES = 1000


def layout_data() -> dict[str, Any]:
    """The kitchen's measures and the placements, which are the same in both racks.

    `blocks` has one bit for each pair of placements, row by row: whether the first one's dish
    stands in the second one's way.
    """
    table = placement_table()
    origin = np.array([*rack_position("top", out=True), 0, 0, 0, 0])
    return {
        "categories": CATEGORIES,
        "extents": [_millimetres(layout.EXTENTS[category][:2]) for category in CATEGORIES],
        "counter": [_millimetres(layout.COUNTER_X), _millimetres(layout.COUNTER_Y)],
        "sink": [_millimetres(layout.SINK_CENTRE), _millimetres(layout.SINK_SIZE[:2])],
        "rack": _millimetres(layout.RACK_INNER),
        "placements": [
            [int(category), *_projection(layout.EXTENTS[CATEGORIES[category]], pose)]
            for category, pose in zip(table.category, table.pose["top"] - origin, strict=True)
        ],
        "blocks": base64.b64encode(np.packbits(table.blocks).tobytes()).decode(),
    }


def session_data(session: Session) -> dict[str, Any]:
    """A session's dishes and the expert's decisions."""
    return {
        "count": session.count,
        "preference": session.label,
        "present": session.dishes.present,
        "dishes": _on_counter(session),
        "expert": expert_trajectory(session).decisions,
    }


def sessions_data(splits: Iterable[str]) -> dict[str, list[dict[str, Any]]]:
    """All sessions of some splits."""
    return {
        split: [session_data(make_session(split, i)) for i in range(get_split(split).sessions)]
        for split in splits
    }


def preferences_in_words(sessions: dict[str, list[dict[str, Any]]]) -> dict[int, str]:
    """The sentence of each preference that sessions have, by its label."""
    labels = {session["preference"] for of_split in sessions.values() for session in of_split}
    return {label: preference_with(label).in_words for label in sorted(labels)}


def _on_counter(session: Session) -> list[int]:
    """Category, x, y and angle of each dish, in a row."""
    pose = session.dishes.pose
    angle = 2 * np.degrees(np.arctan2(pose[:, 6], pose[:, 3]))
    columns = [session.dishes.category, pose[:, 0] * MILLIMETRES, pose[:, 1] * MILLIMETRES, angle]
    return np.round(np.stack(columns, axis=1)).astype(int).ravel().tolist()


def _projection(extents: tuple[float, float, float], pose: np.ndarray) -> list[int]:
    """Centre, half axes and angle of an ellipsoid's projection onto the floor."""
    rotation = Rotation.from_quat(pose[3:], scalar_first=True).as_matrix()  # (3, 3)
    axes = rotation * (np.array(extents) / 2)  # (3, 3), a half axis each column
    squares, directions = np.linalg.eigh((axes @ axes.T)[:2, :2])  # the shorter one first
    long = directions[:, 1] * np.sign(directions[:, 1] @ axes[:2, 0] or 1)
    angle = np.degrees(np.arctan2(long[1], long[0]))
    return [*_millimetres(pose[:2]), *_millimetres(np.sqrt(squares[::-1])), round(angle)]


def _millimetres(lengths: Iterable[float]) -> list[int]:
    return [round(float(length) * MILLIMETRES) for length in lengths]
