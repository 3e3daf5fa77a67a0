"""The exact reader of the grammar: how probable each rule is after demonstrations of a user.

Rules about zones and rules about order are independent of each other given a demonstration. Zones:
the sum over hand wash, exceptions, base, overflow and first rack of prior times likelihood, which
is 0 or 1 as the expert is deterministic. The zones of the classes of a base scheme are counted, not
listed: with the sets Z_c of zones that class c may have, the maps from classes to zones that lie in
a set S are prod_c |Z_c & S|, and inclusion and exclusion gives those that use enough zones.
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
SIZE = np.array([[(one & other).bit_count() for other in SETS] for one in SETS])  # (16, 16)
HAS = np.array([[bool(one >> zone & 1) for zone in range(len(ZONES))] for one in SETS])  # (16, 4)


@dataclass(frozen=True, eq=False)
class _Exceptions:
    """Which exceptions explain what was shown, given hand wash, overflow and first rack.

    A hypothesis is none, one or two exceptions, K of them; the masks are of all dishes.

    Attributes:
        weight: The prior times the share of zones that explain, (K,).
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
    """

    def __init__(self, evidence: Sequence[Evidence]) -> None:
        self.evidence = joined([NOTHING, *evidence])

    def zones(self, dishes: DescribedDishes) -> np.ndarray:
        """How probable each zone is for each dish, the last washed by hand, (m, 5)."""
        reading = _ZoneReading(self.evidence, dishes)
        return reading.zones / reading.zones.sum(axis=1, keepdims=True)

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

    def guess(self, dishes: DescribedDishes) -> LoadingPlan:
        """How the user would most probably load some dishes."""
        reading = _ZoneReading(self.evidence, dishes)
        return LoadingPlan(
            zones=reading.zones.argmax(axis=1),
            ranks=self._most_probable_ranks(dishes),
            first=RACKS[int(reading.first.argmax())],
            overflow=list(OVERFLOWS)[int(reading.overflow.argmax())],
            style=STYLES[int(self.evidence.styles.argmax())],
        )

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

    def __init__(self, evidence: Evidence, dishes: DescribedDishes) -> None:
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
                    known[allowed.tobytes()] = self._read(allowed)
                zones, weight = known[allowed.tobytes()]
                self.zones += zones
                self.overflow[overflow] += weight
                self.first[first] += weight

    def _read(self, allowed: np.ndarray) -> tuple[np.ndarray, float]:
        """The weight of each zone, (m, 5), and of all, given overflow and first rack."""
        zones, total = np.zeros_like(self.zones), 0.0
        for by_hand, prior in zip(self._dishes.by_hand, HAND.values(), strict=True):
            shown = by_hand[: self._shown]
            if not allowed[shown, SINK_ZONE].all() or not allowed[~shown, :SINK_ZONE].any(1).all():
                continue
            of_hand, weight = self._read_given_hand(allowed[:, :SINK_ZONE], by_hand)
            zones += prior * of_hand
            total += prior * weight
        return zones, total

    def _read_given_hand(
        self, allowed: np.ndarray, by_hand: np.ndarray
    ) -> tuple[np.ndarray, float]:
        shown = self._shown
        exceptions = self._exceptions(allowed, by_hand)
        base = ~(exceptions.first | exceptions.second | by_hand)  # (K, N)
        zones, weight = np.zeros_like(self.zones), np.zeros(len(base))
        for scheme, prior in SCHEME.items():
            classes = self._dishes.classes[scheme]
            free = _free_zones(allowed, base[:, :shown], classes[:shown], len(CLASSES[scheme]))
            distinct, which = np.unique(free, axis=0, return_inverse=True)
            counts, marginals = _count_bases(distinct)  # (D,), (D, C, 4)
            own = prior * exceptions.weight * counts[which]  # (K,)
            weight += own
            routed = np.zeros((len(distinct), base.shape[1] - shown))  # (D, m)
            np.add.at(routed, which, own[:, None] * base[:, shown:])
            zones[:, :SINK_ZONE] += np.einsum("dm,dmz->mz", routed, marginals[:, classes[shown:]])
        first, second = exceptions.first[:, shown:], exceptions.second[:, shown:]
        zones[:, :SINK_ZONE] += (weight[:, None] * first).T @ exceptions.first_zone
        zones[:, :SINK_ZONE] += (weight[:, None] * second).T @ exceptions.second_zone
        zones[by_hand[shown:], SINK_ZONE] += weight.sum()
        return zones, float(weight.sum())

    def _exceptions(self, allowed: np.ndarray, by_hand: np.ndarray) -> _Exceptions:
        shown = self._shown
        masks, prior = self._dishes.exceptions  # (G, N), (G,)
        own = masks & ~by_hand
        wrong = (~allowed & ~by_hand[:shown, None]).astype(float)  # (n, 4)
        of_shown = own[:, :shown].astype(float)
        one = of_shown @ wrong == 0  # (G, 4): the zones that explain all dishes of an exception
        both = np.einsum("gn,hn,nz->ghz", of_shown, of_shown, wrong)
        two = (of_shown @ wrong)[None] - both < 0.5  # (G, G, 4): those of a second one
        share_one, share_two = one.mean(axis=1), two.mean(axis=2)
        single = np.flatnonzero(share_one)
        g, h = np.nonzero(share_one[:, None] * share_two)
        none = np.zeros((1, own.shape[1]), dtype=bool)
        nowhere = np.zeros((1 + len(single), len(ZONES)))
        weight = [
            np.array([EXCEPTIONS[0]]),
            EXCEPTIONS[1] * prior[single] * share_one[single],
            EXCEPTIONS[2] * prior[g] * prior[h] * share_one[g] * share_two[g, h],
        ]
        return _Exceptions(
            weight=np.concatenate(weight),
            first=np.concatenate([none, own[single], own[g]]),
            second=np.concatenate([none.repeat(1 + len(single), axis=0), own[h] & ~own[g]]),
            first_zone=np.concatenate([nowhere[:1], _shares(one[single]), _shares(one[g])]),
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
            (distinct, np.bincount(which, prior)),
            {s: both(one.classes(s) for one in (shown, asked)) for s in SCHEME},
        )


def _free_zones(
    allowed: np.ndarray, base: np.ndarray, classes: np.ndarray, count: int
) -> np.ndarray:
    """The zones that each class may have, as bits, (K, C) int.

    Args:
        allowed: The zones of each dish, (n, 4) bool.
        base: The dishes that go where their class goes, (K, n) bool.
        classes: The class of each dish, (n,) int.
        count: C, how many classes there are.
    """
    bits = allowed @ (1 << np.arange(len(ZONES)))  # (n,)
    told = np.where(base, bits, SETS[-1])  # (K, n)
    of_class = (told[:, classes == c] for c in range(count))
    together = [np.bitwise_and.reduce(own, axis=1, initial=SETS[-1]) for own in of_class]
    return np.stack(together, axis=1)


def _count_bases(free: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """How many of the bases of a scheme are possible, and with which zone of each class.

    Args:
        free: The zones that each class may have, as bits, (D, C) int.

    Returns:
        The share of possible bases, (D,), and the probability of each zone of each class,
        (D, C, 4), 0 where no base is possible.
    """
    signs, every = _inclusion_exclusion(free.shape[1])  # (16,)
    sizes = SIZE[free]  # (D, C, 16)
    counts = sizes.prod(axis=1) @ signs  # (D,)
    marginals = np.zeros((*free.shape, len(ZONES)))
    for c in range(free.shape[1]):
        others = np.delete(sizes, c, axis=1).prod(axis=1) * signs  # (D, 16)
        marginals[:, c] = (others @ HAS) * HAS[free[:, c]]
    return counts / every, marginals / np.maximum(counts, 1)[:, None, None]


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
    return signs, float(signs @ SIZE[-1].astype(float) ** classes)


@cache
def every_ranking(classes: int) -> np.ndarray:
    """All rankings of so many classes, (R, C) int."""
    return np.array(list(permutations(range(classes))))


def _shares(zones: np.ndarray) -> np.ndarray:
    """Sets of zones, (K, 4) bool, as probabilities, (K, 4)."""
    return zones / np.maximum(zones.sum(axis=1, keepdims=True), 1)
