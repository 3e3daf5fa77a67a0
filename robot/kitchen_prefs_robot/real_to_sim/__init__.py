"""From what the robot sees to what the policy reads: positions, heights and sizes of the kitchen.

work_area   the counter: measured corners, and the map fitted to them
conversion  a look as the state of the task
"""

from kitchen_prefs_robot.real_to_sim.conversion import to_drawers_state
from kitchen_prefs_robot.real_to_sim.work_area import WorkArea, measure_counter

__all__ = ["WorkArea", "measure_counter", "to_drawers_state"]
