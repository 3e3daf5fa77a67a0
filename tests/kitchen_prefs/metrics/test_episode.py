"""What the facts of an episode must satisfy."""

from dataclasses import replace

import pytest
from made_up_episodes import episode_of


def test_facts_that_do_not_agree_are_refused():
    with pytest.raises(ValueError, match=r"session 0 of seen.*differ in length"):
        replace(episode_of(), refused=())
    with pytest.raises(ValueError, match="nothing to compare"):
        replace(episode_of(), expert_decisions=(), expert_kinds=())
