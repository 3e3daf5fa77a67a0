"""The expert, rolled out in an environment."""

from kitchen_prefs import instances
from kitchen_prefs.envs.actions import nearest_row


def roll_out_expert(env, observation):
    """Let the expert act through poses; yields the row it chooses and what each step returns."""
    terminated = False
    while not terminated:
        action = env.simulator.expert_action()
        row, _ = nearest_row(instances.unpad(observation["instances"]), action)
        observation, _, terminated, _, _ = step = env.step(action)
        yield row, step
