"""The exact sizes and poses that observations have, for observation.js.

Drawings are content with millimetres; a policy is to see in the page the very float32 numbers that
it sees in the environment. Few numbers are JSON's, long lists are float32 in base64.
"""

import base64
from typing import Any

import numpy as np

from kitchen_prefs import instances
from kitchen_prefs.envs.observations import DOOR_ROWS, EXTENTS, RACK_ROWS
from kitchen_prefs.preferences import RACKS
from kitchen_prefs.simulation.kitchen import SINK_POSE, placement_table
from kitchen_prefs.simulation.sessions import Session
from kitchen_prefs.web.kitchen_data import session_data


def observed_kitchen() -> dict[str, Any]:
    """What observations show of every session's kitchen, the page's `data.observed`."""
    return {
        "door": _fixture(DOOR_ROWS),
        "racks": {rack: _fixture(RACK_ROWS[rack]) for rack in RACKS},
        "extents": EXTENTS.tolist(),
        "sink": SINK_POSE.tolist(),
        "placements": {rack: _base64(placement_table().pose[rack]) for rack in RACKS},
    }


def observed_session(session: Session) -> dict[str, Any]:
    """A session's data with the exact poses of its dishes on the counter, (n, 7)."""
    return session_data(session) | {"poses": _base64(session.dishes.pose)}


def _fixture(rows: list[np.ndarray]) -> dict[str, Any]:
    """The extents of the door or a rack, and its poses before and after it is moved."""
    return {
        "extents": rows[0][instances.EXTENTS].tolist(),
        "poses": [row[instances.POSE].tolist() for row in rows],
    }


def _base64(numbers: np.ndarray) -> str:
    return base64.b64encode(numbers.astype("<f4").tobytes()).decode()
