"""The whole of it: look, convert, decide, execute, look again.

conditions        what is real and what is given: perception, grasps, colours, light, noise
looking           one look at the table, by the cameras or by what is true
whereabouts       where the dishes truly are
hands             pick, drop, open and close, by the arm or by an invisible hand
step              one decision and what came of it
episode           one scene loaded decision by decision
outcomes          what came of it
causes            what each dish that is not right failed by
watching          who is told what happens
prompts           a person's demonstration in another scene
trials            a policy in many scenes, under conditions
outcome_files     their outcomes, so that a table resumes
environment       `kitchen_prefs/Drawers-v0`
decision_log      the log of an episode
video             its captioned video
rerun_log         the same for rerun's viewer
commands          `kitchen-prefs robot run` and `kitchen-prefs robot table`
"""
