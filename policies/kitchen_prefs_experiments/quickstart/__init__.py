"""`kitchen-prefs quickstart`: from nothing to a scored policy, a table and pictures.

training   lerobot-train on a recipe, with a progress bar and a log
report     the table and the learning curve
pictures   a start, an end and an animated episode
command    the command that does all of it
"""
