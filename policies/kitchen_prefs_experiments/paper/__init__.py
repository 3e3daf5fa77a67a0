"""`kitchen-prefs reproduce` and `kitchen-prefs results`: the paper's tables, re-run in our kitchen.

policies   what is evaluated: committed checkpoints, rules, trainings of a recipe, fine-tunings
rows       the policies that stand in the tables' rows
table      what a table is, and what a table of learning curves is
tables     what each table holds and what the paper says; a new table is a new entry there
processes  another command, with a progress bar and a log
runs       a run of lerobot-train, and what lies beside it
training   lerobot-train, resumed where it was stopped
players    policies that are ready to be played: trained where they have to be
groups     the metrics of a table's groups, from the lines that evaluations wrote
running    all that a table needs, and the facts that come of it
learning   the same for the learning curves of the recipes
facts      results/TABLE.json, written and read
pictures   results/TABLE.png, drawn from the facts
report     the pages of docs/results, written from the facts
command    the two commands
"""
