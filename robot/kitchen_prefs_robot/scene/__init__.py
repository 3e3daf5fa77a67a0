"""The robot's table as one MuJoCo model, in the frame of the robot's base: z = 0 is the table.

layout     where things stand, and their measures
tableware  the dishes of this table: sizes, colours and solids
sampling   a scene drawn from a seed
assets     the arm's model file in the installed package gym-hil, its meshes simplified
arm        the arm and its gripper, driven by position servos
furniture  table, cabinet with two drawers, stands
tags       fiducial markers
views      three cameras, lamp and background
model      all of it as one specification
world      the compiled model and its state
pictures   colour and depth of a world
"""

from kitchen_prefs_robot.scene.pictures import Pictures
from kitchen_prefs_robot.scene.sampling import PAPER_DISHES, Dish, Scene, sample_scene
from kitchen_prefs_robot.scene.tags import TAGS, tag_corners
from kitchen_prefs_robot.scene.world import World

__all__ = [
    "PAPER_DISHES",
    "TAGS",
    "Dish",
    "Pictures",
    "Scene",
    "World",
    "sample_scene",
    "tag_corners",
]
