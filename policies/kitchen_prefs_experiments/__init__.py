"""What trains and compares policies: the quickstart, reinforcement learning, the paper's tables."""
