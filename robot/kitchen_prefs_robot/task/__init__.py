"""The two drawers as a decision problem, without a robot and without physics."""
