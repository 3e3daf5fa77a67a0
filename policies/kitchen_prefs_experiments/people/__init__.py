"""The second tier's tables, what simple readers of demonstrations reach, and its figure."""
