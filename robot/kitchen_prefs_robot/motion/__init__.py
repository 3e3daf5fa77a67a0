"""Motions of the arm under contact physics; each ends in an outcome, within a limited time.

kinematics   where the joints must be so that the hand is where it should be
moves        minimum-jerk paths, followed at 50 Hz
obstacles    whether a path would strike the furniture or the arm itself
hand         the room that the open hand takes
grasps       where fingers can hold an object that is known by its points
outcomes     how a motion can end
picking      pick a dish, or put it back
dropping     drop it into an open drawer
drawers      open and close a drawer by its handle
seen_points  points of a dish, exact or as cameras see them, for trials
trials       how often single motions succeed
"""

from kitchen_prefs_robot.motion.drawers import close_drawer, open_drawer
from kitchen_prefs_robot.motion.dropping import drop
from kitchen_prefs_robot.motion.obstacles import Furniture
from kitchen_prefs_robot.motion.outcomes import Outcome, Result
from kitchen_prefs_robot.motion.picking import PickOutcome, pick, put_back

__all__ = [
    "Furniture",
    "Outcome",
    "PickOutcome",
    "Result",
    "close_drawer",
    "drop",
    "open_drawer",
    "pick",
    "put_back",
]
