"""From what the robot sees to what the policy reads: positions, heights and sizes of the kitchen.

work_areas  the counter and both drawers: measured corners, and the maps fitted to them
conversion  a look as the state of the task
"""

from kitchen_prefs_robot.real_to_sim.conversion import to_drawers_state
from kitchen_prefs_robot.real_to_sim.work_areas import WorkArea, measure_work_areas

__all__ = ["WorkArea", "measure_work_areas", "to_drawers_state"]
