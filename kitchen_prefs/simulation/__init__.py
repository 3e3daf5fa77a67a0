"""The kitchen's rules without physics: where things are, what a decision changes, who decides what.

layout          the kitchen's measures
placements      where dishes can stand in a rack, and which places block each other
kitchen         joints, where each dish is, what a decision changes
expert          the scripted expert
counter_layout  random poses on the counter
sessions        what session i of a split is
"""
