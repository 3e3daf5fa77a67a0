"""`kitchen-prefs reproduce` and `kitchen-prefs results`: the paper's tables, re-run in our kitchen.

policies   what is evaluated: committed checkpoints, rules, and trainings of a recipe
tables     what each table holds and what the paper says; a new table is a new entry there
processes  another command, with a progress bar and a log
training   lerobot-train, resumed where it was stopped
running    all that a table needs, and the facts that come of it
facts      results/TABLE.json, written and read
pictures   results/TABLE.png, drawn from the facts
report     RESULTS.md, written from the facts
command    the two commands
"""
