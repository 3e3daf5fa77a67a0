"""`kitchen-prefs quickstart`: from nothing to a scored policy, a table and pictures.

report            the table and the learning curve
episode_pictures  a start, an end and an animated episode
commands          the command `kitchen-prefs quickstart`
"""
