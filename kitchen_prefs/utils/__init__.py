"""Utilities that are independent of the kitchen.

decoder_log      LeRobot's warning about its video decoder, as one sentence
extras           packages that only a part of the benchmark needs
files            files and folders that are whole or not there
hub              the Hugging Face hub
processes        other commands, with a progress bar and a log
suggestions      what a wrong name was probably meant to be
untrusted_files  files of strangers, read within limits into a model
visible_text     names and links of strangers
"""
