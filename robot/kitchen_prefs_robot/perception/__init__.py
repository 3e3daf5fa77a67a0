"""What the robot sees, from the three cameras' pictures alone.

depth_noise     what a depth camera gets wrong
depth_filter    its images made smoother
calibration     where a camera stands, from tags
cameras         the three calibrated cameras of a world
cloud           coloured points
plane           the table
drawer_opening  how far a drawer is open
regions         counter, hand and open drawers, cut out of the cloud
clusters        objects as clusters of points, and the boxes round them
categories      categories by median colour
detection       all of it: a cloud in, dishes and openings out
known_dishes    the colours of the dishes, measured beforehand
trials          how well it does on random scenes
pictures        what was found, tinted in a camera's picture
commands        `kitchen-prefs robot perception`
"""

from kitchen_prefs_robot.perception.cameras import Cameras, calibrate, laboratory_poses
from kitchen_prefs_robot.perception.categories import KnownDish
from kitchen_prefs_robot.perception.cloud import Cloud, Frame
from kitchen_prefs_robot.perception.detection import Detection, Sight, perceive
from kitchen_prefs_robot.perception.known_dishes import known_dishes
from kitchen_prefs_robot.perception.regions import HAND, open_drawer

__all__ = [
    "HAND",
    "Cameras",
    "Cloud",
    "Detection",
    "Frame",
    "KnownDish",
    "Sight",
    "calibrate",
    "known_dishes",
    "laboratory_poses",
    "open_drawer",
    "perceive",
]
