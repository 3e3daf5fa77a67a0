"""The leaderboard: submissions that carry no score, replayed and ranked."""
