"""Policies that need no training: the floor, the references and the ceiling of every table."""
