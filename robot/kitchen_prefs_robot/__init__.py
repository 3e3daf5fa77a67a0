"""A simulated robot that loads two drawers as one person showed it: pictures in, torques out.

The paper's experiment on hardware, with a simulated arm in the place of the laboratory's. It stands
on the benchmark, which does not know of it; the extra `robot` brings what it needs.

task            the drawers as a decision problem, without a robot
scene           arm, table, cabinet with two drawers, dishes, tags and cameras as one MuJoCo model
motion          moves the arm: picks dishes, drops them, opens and closes drawers
perception      from three cameras' pictures to dishes and drawers
real_to_sim     what is seen, as the policy's kitchen has it
demonstrations  a person shows it, and the cameras look
execution       look, convert, decide, execute; `kitchen_prefs/Drawers-v0`
lerobot         LeRobot's view of that environment
commands        `kitchen-prefs robot`
"""

import gymnasium

gymnasium.register("kitchen_prefs/Drawers-v0", "kitchen_prefs_robot.execution.environment:Drawers")
