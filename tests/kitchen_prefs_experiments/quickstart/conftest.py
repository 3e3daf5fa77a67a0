"""Episodes of the symbolic rule."""

import pytest

from kitchen_prefs.evaluation.policy_loading import load_policy
from kitchen_prefs.evaluation.rollouts import roll_out


@pytest.fixture(scope="module")
def episodes():
    loaded_policy = load_policy(policy_type="rules", options=["--rule=symbolic"])
    return roll_out(loaded_policy, "unseen_preferences", sessions=range(4))
