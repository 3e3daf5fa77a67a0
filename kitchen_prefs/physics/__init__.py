"""Contact physics in MuJoCo: how the committed placements were made and checked.

shapes            the solids that a dish collides with
dish_bodies       dishes as MuJoCo bodies
rack              the rack's wires
settling          dishes dropped into a rack until they rest
blocking          which placements block each other
carrying          whether a load stays when its rack slides in
placement_search  settle many, keep those farthest apart
commands          `kitchen-prefs physics`
"""
