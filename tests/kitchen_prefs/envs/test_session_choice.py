"""Which session a reset starts."""

import pytest
from lerobot.envs.utils import NEW_ROLLOUT_OPTION

from kitchen_prefs.envs.environment import DishwasherLoading


def test_seeds_start_the_sessions_in_turn():
    env = DishwasherLoading("seen")
    for seed in (0, 69, 70, 1000):
        _, info = env.reset(seed=seed)
        assert info["session"] == seed % 70


def test_an_unseeded_reset_starts_a_fresh_session():
    env = DishwasherLoading("seen")
    env.reset(seed=4)
    fresh = []
    for _ in range(5):
        env.reset()
        fresh.append((env.session.salt, env.session.index))
    assert len(set(fresh)) == 5
    assert all(salt > 0 for salt, _ in fresh)
    env.reset(seed=4)
    env.reset()
    assert (env.session.salt, env.session.index) == fresh[0]


def test_a_salt_alone_draws_one_of_its_sessions():
    env = DishwasherLoading("seen")
    env.reset(seed=4)
    drawn = set()
    for _ in range(8):
        env.reset(options={"salt": 5})
        assert env.session.salt == 5
        drawn.add(env.session.index)
    assert len(drawn) > 4
    env.reset(seed=71, options={"salt": 5})
    assert (env.session.salt, env.session.index) == (5, 1)
    env.reset(seed=71, options={"salt": 5, "session": 33})
    assert (env.session.salt, env.session.index) == (5, 33)


def test_lerobots_own_option_is_let_through():
    env = DishwasherLoading("seen")
    env.reset(seed=9, options={NEW_ROLLOUT_OPTION: True})
    assert env.session.index == 9


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"sesion": 3}, "no option 'sesion'. Did you mean 'session'"),
        ({"index": 3}, "There are: session, salt"),
        ({"session": 3.5}, "'session' is a whole number, not 3.5"),
        ({"session": 70}, r"0\.\.69"),
        ({"salt": -1}, "natural number"),
    ],
)
def test_impossible_options_are_refused_in_one_sentence(options, words):
    with pytest.raises(ValueError, match=words):
        DishwasherLoading("seen").reset(options=options)
