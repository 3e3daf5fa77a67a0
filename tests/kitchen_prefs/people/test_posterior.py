"""The exact reader: the truth is never excluded, and what it says is as often true as it says."""

from itertools import product

import numpy as np
import pytest

from kitchen_prefs.people.attributes import draw_dishes
from kitchen_prefs.people.evidence import evidence_of
from kitchen_prefs.people.expert import roll_out_plan
from kitchen_prefs.people.posterior import Posterior, sum_bases
from kitchen_prefs.people.sessions import make_people_session
from kitchen_prefs.people.splits import SLIPS
from kitchen_prefs.people.user_sampling import is_base, sample_user
from kitchen_prefs.people.users import STYLES
from kitchen_prefs.people.zones import OVERFLOW_INDEX
from kitchen_prefs.preferences import RACKS
from kitchen_prefs.simulation.kitchen import Kitchen

USERS = range(50)


def shown_by(user, generator):
    dishes = draw_dishes(int(generator.integers(16, 19)), generator)
    kitchen = Kitchen(dishes)
    decisions = roll_out_plan(kitchen, user.plan(dishes)).decisions
    return evidence_of(dishes, kitchen.table, decisions)


@pytest.fixture(scope="module")
def readings():
    """Users, what one demonstration of each says, other dishes, and what is read of these."""
    found = []
    for seed in USERS:
        generator = np.random.default_rng(seed)
        user = sample_user(generator)
        evidence = shown_by(user, generator)
        dishes = draw_dishes(17, generator)
        posterior = Posterior([evidence])
        found.append((user, evidence, dishes, posterior, posterior.zones(dishes)))
    return found


def test_the_truth_is_never_excluded(readings):
    for user, evidence, dishes, posterior, zones in readings:
        own = user.zones(evidence.dishes)
        first, overflow = RACKS.index(user.first), OVERFLOW_INDEX[user.overflow]
        assert evidence.allowed[first, overflow, np.arange(len(own)), own].all()
        ranks = user.ranks(evidence.dishes)
        taken, waiting = ranks[evidence.taken], ranks[evidence.waiting]
        assert ((taken < waiting) | ((taken == waiting) & evidence.nearer)).all()
        assert evidence.styles[STYLES.index(user.style)]
        assert (zones[np.arange(len(zones)), user.zones(dishes)] > 0).all()
        assert posterior.orders[user.order.scheme if user.order else None] > 0


def test_probabilities_are_probabilities(readings):
    for *_, dishes, posterior, zones in readings:
        assert (zones >= 0).all()
        assert zones.sum(axis=1) == pytest.approx(1)
        earlier = posterior.earlier(dishes)
        assert (earlier + earlier.T <= 1 + 1e-9).all()


def test_what_it_says_is_as_often_true_as_it_says(readings):
    said, true = [], []
    for user, _, dishes, _, zones in readings:
        said += zones.max(axis=1).tolist()
        true += (zones.argmax(axis=1) == user.zones(dishes)).tolist()
    assert np.mean(true) == pytest.approx(np.mean(said), abs=0.03)
    assert np.mean(said) > 0.85
    said, true = [], []
    for user, _, dishes, posterior, _ in readings:
        ranks = user.ranks(dishes)
        said += posterior.earlier(dishes).ravel().tolist()
        true += (ranks[:, None] < ranks[None]).ravel().tolist()
    assert np.mean(true) == pytest.approx(np.mean(said), abs=0.03)
    sure = np.array(said) > 0.95
    assert np.array(true)[sure].mean() > 0.95


def test_without_a_demonstration_it_is_the_prior():
    generator = np.random.default_rng(0)
    dishes = draw_dishes(16, generator)
    empty = Posterior([])
    zones = np.stack([sample_user(generator).zones(dishes) for _ in range(4000)])
    frequent = (zones[..., None] == np.arange(5)).mean(axis=0)
    assert empty.zones(dishes) == pytest.approx(frequent, abs=0.03)


def test_three_demonstrations_say_more_than_one():
    surer = []
    for seed in range(12):
        generator = np.random.default_rng(100 + seed)
        user = sample_user(generator)
        shown = [shown_by(user, generator) for _ in range(3)]
        dishes = draw_dishes(17, generator)
        one, three = (
            Posterior(some).zones(dishes).max(axis=1).mean() for some in (shown[:1], shown)
        )
        surer.append(three - one)
    assert np.mean(surer) > 0.02


@pytest.mark.parametrize("classes", [3, 4])
def test_bases_are_summed_as_if_they_were_listed(classes):
    generator = np.random.default_rng(classes)
    every = [zones for zones in product(range(4), repeat=classes) if is_base(zones)]
    likelihood = generator.random((20, classes, 4)) * generator.integers(2, size=(20, classes, 4))
    shares, marginals = sum_bases(likelihood)
    for own, share, parts in zip(likelihood, shares, marginals, strict=True):
        listed = {z: np.prod([own[c, zone] for c, zone in enumerate(z)]) for z in every}
        assert share == pytest.approx(sum(listed.values()) / len(every))
        for c, zone in product(range(classes), range(4)):
            having = sum(value for z, value in listed.items() if z[c] == zone)
            assert parts[c, zone] == pytest.approx(having / len(every))


def test_who_reckons_with_slips_is_not_misled_by_them():
    """Of sessions with slips in their prompts; without slips reckoned with, nothing explains."""
    right = []
    for index in range(8):
        session = make_people_session("people_inconsistent", index)
        evidence = [prompt.evidence for prompt in session.prompts]
        zones = Posterior(evidence, slips=SLIPS).zones(session.dishes)
        right += (zones.argmax(axis=1) == session.user.zones(session.dishes)).tolist()
    assert np.mean(right) > 0.85
