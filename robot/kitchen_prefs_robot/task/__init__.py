"""The two drawers as a decision problem, without a robot and without physics.

state           what one decision knows
preferences     which drawer comes first, and what goes where in which order
decisions       what can be chosen in a state, and what is refused
sessions        a session drawn from a seed, and its prompt's
rows            the instance set that a policy reads, and what its action chooses
summaries       the flat summary of a state, for data sets
expert          the scripted expert
simulator       a session decision by decision, seen through imperfect perception
demonstrations  the expert's demonstration, as a prompt
dataset         demonstrations for training, as a LeRobot data set
metrics         the paper's success; PE and ED as in the kitchen
rollouts        a policy on many sessions
conditions      better and worse perception, and the opposite prompt
commands        `kitchen-prefs robot task` and `kitchen-prefs robot data`
"""
