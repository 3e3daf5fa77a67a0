"""A simulated robot that loads two drawers as one person showed it: pictures in, torques out.

task      the drawers as a decision problem, without a robot
scene     arm, table, cabinet with two drawers, dishes, tags and cameras as one MuJoCo model
motion    moves the arm: picks dishes, drops them, opens and closes drawers
commands  `kitchen-prefs robot`
"""
