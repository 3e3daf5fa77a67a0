"""The second tier's tables: what simple readers of a user's demonstrations reach."""
