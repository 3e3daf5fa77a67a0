"""Demonstrations of people: the page's files, replayed, kept in data sets, held against each other.

file_format  the file that the page gives, as a pydantic model
kitchens     the sessions that the page shows
replaying    replays a file in the kitchen
"""
