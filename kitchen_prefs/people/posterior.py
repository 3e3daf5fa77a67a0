"""The exact reader of the grammar: how probable each rule is after demonstrations of a user.

Rules about zones and rules about order are independent of each other given a demonstration. Zones:
the sum over hand wash, exceptions, base, overflow and first rack of prior times likelihood. The
likelihood is a product over the dishes; without slips its factors are 0 or 1, as the expert is
deterministic. The zones of the classes of a base scheme are summed, not listed: with the likelihood
w_c(z) that class c has zone z, the maps from classes to zones in a set S have the sum
prod_c sum_{z in S} w_c(z), and inclusion and exclusion gives those that use enough zones.
"""

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache, cached_property
from itertools import permutations

import numpy as np

from kitchen_prefs.people.attributes import CLASSES, DescribedDishes
from kitchen_prefs.people.evidence import NOTHING, Evidence, joined
from kitchen_prefs.people.user_sampling import (
    EXCEPTION_KINDS,
    EXCEPTIONS,
    HAND,
    LEAST_ZONES,
    NO_ORDER,
    SCHEME,
    is_base,
)
from kitchen_prefs.people.users import STYLES, LoadingPlan, every_exception
from kitchen_prefs.people.zones import LONGEST, OVERFLOWS, SINK_ZONE, ZONES
from kitchen_prefs.preferences import RACKS

SETS = range(2 ** len(ZONES))  # sets of zones as bits
HAS = np.array([[bool(one >> zone & 1) for zone in range(len(ZONES))] for one in SETS])  # (16, 4)
IMPOSSIBLE = 1e-200  # its logarithm stands for that of 0
NOT_EXPLAINED = np.log(IMPOSSIBLE) / 2  # by any zone, if the logarithm is lower
NEGLIGIBLE = 1e-9  # hypotheses that weigh less than this share of the heaviest are left out


@dataclass(frozen=True, eq=False)
class _Exceptions:
    """How well exceptions explain what was shown, given hand wash, overflow and first rack.

    A hypothesis is none, one or two exceptions, K of them; the masks are of all dishes.

    Attributes:
        weight: The prior times the mean likelihood of the zones, (K,).
        first: The dishes of the first exception, (K, N) bool.
        second: The dishes of the second that are none of the first, (K, N) bool.
        first_zone: The zone of the first, how probable each is, (K, 4).
        second_zone: The zone of the second, (K, 4).
    """

    weight: np.ndarray
    first: np.ndarray
    second: np.ndarray
    first_zone: np.ndarray
    second_zone: np.ndarray


class Posterior:
    """What is known of a user after some demonstrations.

    Args:
        evidence: Of each demonstration; with none, this is the prior.
        slips: The share of dishes that the user puts into another zone by mistake.
    """

    def __init__(self, evidence: Sequence[Evidence], slips: float = 0.0) -> None:
        self.evidence = joined([NOTHING, *evidence])
        self.slips = slips
        self._last: tuple[DescribedDishes, _ZoneReading] | None = None

    @property
    def is_possible(self) -> bool:
        """Whether some user's rules about zones explain all demonstrations."""
        return bool(self._reading(NOTHING.dishes).overflow.sum() > IMPOSSIBLE)

    def zones(self, dishes: DescribedDishes) -> np.ndarray:
        """How probable each zone is for each dish, the last washed by hand, (m, 5)."""
        weights = self._reading(dishes).zones
        return weights / weights.sum(axis=1, keepdims=True)

    def earlier(self, dishes: DescribedDishes) -> np.ndarray:
        """How probable it is that the rank of one dish is lower than another's, (m, m)."""
        total = sum(self.orders.values())
        lower = np.zeros((len(dishes.category),) * 2)
        for scheme, weight in self.orders.items():
            if scheme is not None and weight:
                ranks, classes = self._consistent_ranks[scheme], dishes.classes(scheme)
                before = (ranks[:, :, None] < ranks[:, None, :]).mean(axis=0)  # (C, C)
                lower += weight / total * before[np.ix_(classes, classes)]
        return lower

    @cached_property
    def orders(self) -> dict[str | None, float]:
        """The weight of each scheme of order, and of none."""
        weights: dict[str | None, float] = {None: NO_ORDER * bool(self.evidence.nearer.all())}
        for scheme, prior in SCHEME.items():
            share = len(self._consistent_ranks[scheme]) / len(every_ranking(len(CLASSES[scheme])))
            weights[scheme] = (1 - NO_ORDER) * prior * share
        return weights

    def overflows(self, dishes: DescribedDishes) -> dict[str, float]:
        """How probable each overflow is."""
        weights = self._reading(dishes).overflow
        return dict(zip(OVERFLOWS, (weights / weights.sum()).tolist(), strict=True))

    def guess(self, dishes: DescribedDishes) -> LoadingPlan:
        """How the user would most probably load some dishes."""
        reading = self._reading(dishes)
        return LoadingPlan(
            zones=reading.zones.argmax(axis=1),
            ranks=self._most_probable_ranks(dishes),
            first=RACKS[int(reading.first.argmax())],
            overflow=list(OVERFLOWS)[int(reading.overflow.argmax())],
            style=STYLES[int(self.evidence.styles.argmax())],
        )

    def _reading(self, dishes: DescribedDishes) -> "_ZoneReading":
        """What is read of the zones of some dishes; the last one is kept."""
        if self._last is None or self._last[0] is not dishes:
            self._last = (dishes, _ZoneReading(self.evidence, self.slips, dishes))
        return self._last[1]

    def _most_probable_ranks(self, dishes: DescribedDishes) -> np.ndarray:
        scheme = max(self.orders, key=lambda name: self.orders[name])
        if scheme is None:
            return np.zeros(len(dishes.category), dtype=int)
        return self._consistent_ranks[scheme].mean(axis=0)[dishes.classes(scheme)]

    @cached_property
    def _consistent_ranks(self) -> dict[str, np.ndarray]:
        """For each scheme the rankings of its classes that explain the order, (R, C) each."""
        return {scheme: self._rankings(scheme) for scheme in SCHEME}

    def _rankings(self, scheme: str) -> np.ndarray:
        evidence = self.evidence
        classes = evidence.dishes.classes(scheme)
        taken, waiting = classes[evidence.taken], classes[evidence.waiting]
        rankings = every_ranking(len(CLASSES[scheme]))
        if not evidence.nearer[taken == waiting].all():
            return rankings[:0]
        other = taken != waiting
        for one, two in set(zip(taken[other].tolist(), waiting[other].tolist(), strict=True)):
            rankings = rankings[rankings[:, one] < rankings[:, two]]
        return rankings


class _ZoneReading:
    """The posterior over rules about zones, with what it says of some dishes.

    Attributes:
        zones: The weight of each zone for each dish, (m, 5).
        overflow: The weight of each overflow, (3,).
        first: The weight of each rack as the first, (2,).
    """

    def __init__(self, evidence: Evidence, slips: float, dishes: DescribedDishes) -> None:
        self.zones = np.zeros((len(dishes.category), LONGEST))
        self.overflow = np.zeros(len(OVERFLOWS))
        self.first = np.zeros(len(RACKS))
        self._shown = len(evidence.dishes.category)
        self._dishes = _Described.of(evidence.dishes, dishes)
        known: dict[bytes, tuple[np.ndarray, float]] = {}
        for first in range(len(RACKS)):
            for overflow in range(len(OVERFLOWS)):
                allowed = evidence.allowed[first, overflow]  # (n, 5)
                if allowed.tobytes() not in known:
                    known[allowed.tobytes()] = self._read(_log_likelihood(allowed, slips))
                zones, weight = known[allowed.tobytes()]
                self.zones += zones
                self.overflow[overflow] += weight
                self.first[first] += weight

    def _read(self, likelihood: np.ndarray) -> tuple[np.ndarray, float]:
        """The weight of each zone, (m, 5), and of all, given overflow and first rack.

        Args:
            likelihood: The logarithm of that of what was done with each dish, by its zone, (n, 5).
        """
        zones, total = np.zeros_like(self.zones), 0.0
        if (likelihood.max(axis=1) < NOT_EXPLAINED).any():
            return zones, total
        for by_hand, prior in zip(self._dishes.by_hand, HAND.values(), strict=True):
            of_hand = prior * np.exp(likelihood[by_hand[: self._shown], SINK_ZONE].sum())
            if of_hand > IMPOSSIBLE:
                given_hand, weight = self._read_given_hand(likelihood[:, :SINK_ZONE], by_hand)
                zones += of_hand * given_hand
                total += of_hand * weight
        return zones, total

    def _read_given_hand(
        self, likelihood: np.ndarray, by_hand: np.ndarray
    ) -> tuple[np.ndarray, float]:
        shown = self._shown
        exceptions = self._exceptions(likelihood, by_hand)
        base = ~(exceptions.first | exceptions.second | by_hand)  # (K, N)
        zones, weight = np.zeros_like(self.zones), np.zeros(len(base))
        for scheme, prior in SCHEME.items():
            classes = self._dishes.classes[scheme]
            of_class = np.eye(len(CLASSES[scheme]))[classes]  # (N, C)
            told = np.einsum("nc,nz->ncz", of_class[:shown], likelihood)  # (n, C, 4)
            shares, marginals = sum_bases(np.exp(np.tensordot(base[:, :shown], told, axes=1)))
            own = prior * exceptions.weight
            weight += own * shares
            routed = own[:, None, None] * marginals  # (K, C, 4)
            of_base = np.einsum("km,kcz->mcz", base[:, shown:].astype(float), routed)
            zones[:, :SINK_ZONE] += of_base[np.arange(len(zones)), classes[shown:]]
        first, second = exceptions.first[:, shown:], exceptions.second[:, shown:]
        zones[:, :SINK_ZONE] += (weight[:, None] * first).T @ exceptions.first_zone
        zones[:, :SINK_ZONE] += (weight[:, None] * second).T @ exceptions.second_zone
        zones[by_hand[shown:], SINK_ZONE] += weight.sum()
        return zones, float(weight.sum())

    def _exceptions(self, likelihood: np.ndarray, by_hand: np.ndarray) -> _Exceptions:
        masks, prior = self._dishes.exceptions  # (G, N), (G,)
        own = masks & ~by_hand
        of_shown = own[:, : self._shown].astype(float)  # (G, n)
        one = of_shown @ likelihood  # (G, 4)
        both = np.einsum("gn,hn,nz->ghz", of_shown, of_shown, likelihood)
        one, two = np.exp(one), np.exp(one[None] - both)  # (G, 4), (G, G, 4): of a second one
        single = EXCEPTIONS[1] * prior * one.mean(axis=1)  # (G,)
        pair = EXCEPTIONS[2] * np.outer(prior * one.mean(axis=1), prior) * two.mean(axis=2)
        heaviest = max(EXCEPTIONS[0], single.max(), pair.max())
        (s,) = np.nonzero(single > NEGLIGIBLE * heaviest)
        g, h = np.nonzero(pair > NEGLIGIBLE * heaviest)
        none = np.zeros((1, own.shape[1]), dtype=bool)
        nowhere = np.zeros((1 + len(s), len(ZONES)))
        return _Exceptions(
            weight=np.concatenate([[EXCEPTIONS[0]], single[s], pair[g, h]]),
            first=np.concatenate([none, own[s], own[g]]),
            second=np.concatenate([none.repeat(1 + len(s), axis=0), own[h] & ~own[g]]),
            first_zone=np.concatenate([nowhere[:1], _shares(one[s]), _shares(one[g])]),
            second_zone=np.concatenate([nowhere, _shares(two[g, h])]),
        )


@dataclass(frozen=True, eq=False)
class _Described:
    """All dishes, those that were shown and then those that are asked for, by the rules.

    Attributes:
        by_hand: Those that each rule of hand wash matches, (8, N) bool.
        exceptions: The distinct sets of dishes of exceptions, (G, N) bool, and their priors, (G,).
        classes: The class of each dish by scheme, (N,) int each.
    """

    by_hand: np.ndarray
    exceptions: tuple[np.ndarray, np.ndarray]
    classes: dict[str, np.ndarray]

    @classmethod
    def of(cls, shown: DescribedDishes, asked: DescribedDishes) -> "_Described":
        def both(values: Iterator[np.ndarray]) -> np.ndarray:
            return np.concatenate(list(values))

        def of_predicate(predicate: object) -> np.ndarray:
            if predicate is None:
                return np.zeros(len(shown.category) + len(asked.category), dtype=bool)
            return both(predicate.matches(one) for one in (shown, asked))  # type: ignore[attr-defined]

        predicates = every_exception()
        frequency = Counter(predicate.kind for predicate in predicates)
        prior = [1 / len(EXCEPTION_KINDS) / frequency[p.kind] for p in predicates]
        masks = np.stack([of_predicate(predicate) for predicate in predicates])
        distinct, which = np.unique(masks, axis=0, return_inverse=True)
        return cls(
            np.stack([of_predicate(predicate) for predicate in HAND]),
            (distinct, np.bincount(which.ravel(), prior)),  # NumPy 2.0 gives a column
            {s: both(one.classes(s) for one in (shown, asked)) for s in SCHEME},
        )


def _log_likelihood(allowed: np.ndarray, slips: float) -> np.ndarray:
    """The logarithm of the likelihood of what was done with each dish, by its zone, (n, 5)."""
    likely = allowed.astype(float)
    zones = likely[:, :SINK_ZONE]
    elsewhere = zones.sum(axis=1, keepdims=True)
    slipped = np.hstack([(elsewhere - zones) / (len(ZONES) - 1), elsewhere / len(ZONES)])
    return np.log(np.maximum((1 - slips) * likely + slips * slipped, IMPOSSIBLE))


def sum_bases(likelihood: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Sum over the bases of a scheme, all of which are equally frequent.

    Args:
        likelihood: Of what was done with the dishes of a class, by the zone of the class,
            (K, C, 4).

    Returns:
        The mean likelihood of the bases, (K,), and the part of it in which a class has a zone,
        (K, C, 4).
    """
    signs, count = _inclusion_exclusion(likelihood.shape[1])  # (16,)
    inside = likelihood @ HAS.T  # (K, C, 16): summed over the zones of each set
    before = np.ones_like(inside)
    before[:, 1:] = np.cumprod(inside[:, :-1], axis=1)
    after = np.ones_like(inside)
    after[:, :-1] = np.cumprod(inside[:, :0:-1], axis=1)[:, ::-1]
    others = before * after * signs / count  # (K, C, 16): the product over all other classes
    marginals = (others @ HAS) * likelihood
    return marginals[:, 0].sum(axis=1), marginals


@cache
def _inclusion_exclusion(classes: int) -> tuple[np.ndarray, float]:
    """The sign with which the maps into each set of zones count, (16,), and how many bases are."""
    signs = np.zeros(len(SETS))
    for used in SETS:
        image = [zone for zone in range(len(ZONES)) if used >> zone & 1]
        enough = len(image) >= LEAST_ZONES[classes]
        if enough and is_base(tuple((image * classes)[:classes])):
            for inside in SETS:
                if inside & ~used == 0:
                    signs[inside] += (-1) ** (used.bit_count() - inside.bit_count())
    return signs, float(signs @ HAS.sum(axis=1).astype(float) ** classes)


@cache
def every_ranking(classes: int) -> np.ndarray:
    """All rankings of so many classes, (R, C) int."""
    return np.array(list(permutations(range(classes))))


def _shares(likelihood: np.ndarray) -> np.ndarray:
    """Likelihoods of zones, (K, 4), as probabilities, (K, 4)."""
    return likelihood / np.maximum(likelihood.sum(axis=1, keepdims=True), IMPOSSIBLE)
