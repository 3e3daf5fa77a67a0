"""Demonstrations that a person gives in a page."""
