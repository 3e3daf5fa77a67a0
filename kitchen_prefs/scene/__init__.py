"""The kitchen as MuJoCo sees it: its measures, its physics, its placements, its pictures."""
