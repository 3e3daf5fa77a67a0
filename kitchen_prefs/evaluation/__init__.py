"""Evaluates policies on splits.

tiers                 the two tiers: their splits, kitchens, episodes and metrics
policy_loading        a LeRobot policy with its processors, ready to act
policy_options        the command-line options that name a policy
checkpoint_reading    a checkpoint's files, checked
rollouts              a policy on every session of a split
episode_files         one JSON line per episode
evaluator             a policy's episodes, metrics and failure modes on a split
checkpoint_selection  the best checkpoint of a run, by the headline on val
commands              `kitchen-prefs evaluate` and `kitchen-prefs select`
"""
