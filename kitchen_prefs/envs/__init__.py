"""The gymnasium environment and what it is made of.

observations       what a decision sees, as an instance set and as flat summaries
spaces             the shapes of observations and actions
actions            the row that an action chooses
rewards            the paper's dense reward
session_choice     which session a reset starts
simulator          one session, decision by decision, whatever its tier
episode_simulator  that of the first tier
demonstrations     an episode as a demonstration and as a prompt
given_prompt       a prompt from outside of the benchmark's sessions
kitchen_env        what the environments share
environment        `kitchen_prefs/DishwasherLoading-v0`
lerobot_env        LeRobot's view of it
people_*           the same for the second tier: `kitchen_prefs/DishwasherPeople-v0`
"""
