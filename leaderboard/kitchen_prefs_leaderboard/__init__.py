"""The leaderboard: submissions hold actions and no scores; they are replayed and ranked.

submission_format   the files of a submission, as pydantic models
plugin_identity     which code a policy from elsewhere has
submission_reading  reads a submission, whose files are untrusted
submission_writing  writes a submission from a policy's episodes
recording_reading   reads what lerobot-eval recorded
policy_runs         rolls a policy out on the test splits, on several cores
replay              replays a submission's actions in the simulator
scoring             every metric of a submission, from replays alone
score_formats       scores as a table, as JSON and as CSV
reruns              rolls a submission's policy out again, in processes of its own
judgement           judges a submission by its policy's re-runs
verification        the records of re-runs, which confirm that a checkpoint chose the actions
ranking             the order of the entries, with ties
page                the leaderboard as one HTML file
hub_upload          pushes submissions and the page to the Hugging Face hub
commands            `kitchen-prefs leaderboard`
"""
