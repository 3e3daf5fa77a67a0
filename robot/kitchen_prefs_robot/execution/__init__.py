"""The whole of it: look, convert, decide, execute, look again.

conditions        what is real and what is given: perception, grasps, colours, light, noise
looking           one look at the table, by the cameras or by what is true
whereabouts       where the dishes truly are
hands             pick, drop, open and close, by the arm or by an invisible hand
episode           one scene loaded decision by decision
outcomes          what came of it, and whose fault each dish is that is not right
watching          who is told what happens
prompts           a person's demonstration in another scene
trials            a policy in many scenes, under conditions
environment       `kitchen_prefs/Drawers-v0`
decision_log      the log and the video of an episode
commands          `kitchen-prefs robot run` and `kitchen-prefs robot table`
"""
