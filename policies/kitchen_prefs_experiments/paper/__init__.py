"""`kitchen-prefs reproduce`, `results` and `readme-table`: the paper's tables, in our kitchen.

evaluated_policies  committed checkpoints, rules, trainings and fine-tunings: the tables' rows
table_types         the definitions of a table and of a table of learning curves
paper_tables        each table's rows, splits and metrics, and the paper's values
prepared_policies   policies that are ready to be evaluated: trained where they have to be
table_runner        runs a table: trainings, evaluations, metrics
table_metrics       the metrics of a table's groups, from the episodes on disk
learning_curves     runs the table of learning curves
result_files        docs/results/TABLE.json, written and read
figures             docs/results/TABLE.png, drawn from the results
results_page        docs/results/TABLE.md and the overview, written from the results
readme_table        the README's table, written from the leaderboard's scores
commands            the three commands
"""
