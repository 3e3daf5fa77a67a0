"""The leaderboard: submissions that carry no score (a later version)."""
