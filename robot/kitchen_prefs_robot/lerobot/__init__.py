"""LeRobot's view of the robot, which LeRobot imports where it is asked to.

lerobot-eval --env.discover_packages_path=kitchen_prefs_robot.lerobot \
        --env.type=kitchen_prefs_drawers ...
"""

from kitchen_prefs_robot.lerobot.drawers_env import DrawersEnv

__all__ = ["DrawersEnv"]
