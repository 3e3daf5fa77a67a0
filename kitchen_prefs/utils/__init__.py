"""Utilities that are independent of the kitchen.

files        files and folders that are whole or not there
hub          uploads to the Hugging Face hub
processes    other commands, with a progress bar and a log
suggestions  what a wrong name was probably meant to be
"""
