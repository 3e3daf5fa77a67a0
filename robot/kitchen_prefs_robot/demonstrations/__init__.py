"""A person's demonstration, seen by the robot's cameras and understood by its perception.

preferences   the preferences that are shown
person        who moves dishes and drawers, without the arm
decisions     which decision lies between two looks
recording     one demonstration: pictures, instance sets and chosen rows
storage       demonstrations as a LeRobot data set
loading       such data sets as prompts
verification  whether a data set is the published one
commands      `kitchen-prefs robot demonstrate` and `kitchen-prefs robot verify`
"""
