"""What the robot sees, from the three cameras' pictures alone.

depth_noise     what a depth camera gets wrong
depth_filter    its images made smoother
calibration     where a camera stands, from tags
cameras         the three calibrated cameras of a world
not_seen        what cannot be done without, and is not seen
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
