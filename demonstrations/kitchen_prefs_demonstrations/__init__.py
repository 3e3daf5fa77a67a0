"""Demonstrations of people: the page's files, replayed, kept in data sets, held against each other.

file_format         the file that the page gives, as a pydantic model
kitchens            the sessions that the page shows
replaying           replays a file in the kitchen
implied_preference  which of the known preferences a demonstration follows
importing           files as a data set
habits              where a demonstration puts each category, and in which order
comparison          two demonstrations of one kitchen, held against each other
agreement           users compared with themselves and with others
serving             serves the page and saves what it sends
page                the page
commands            `kitchen-prefs demonstrations` and `kitchen-prefs demonstrate`
"""
