"""What simple readers make of a user's demonstrations: the rules that every table shows.

promptless       the most probable user, whatever was shown
category         the first tier's: each category has a rack and a rank
zone             each category has a zone and a rank
similar          each dish goes where the most similar one that was shown went
tree             a decision tree on attributes gives the zone, another the rank
bayes            the exact reader of the grammar
"""

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from kitchen_prefs.people.attributes import CLASSES, DescribedDishes
from kitchen_prefs.people.evidence import Evidence, joined_dishes
from kitchen_prefs.people.expert import ends_of
from kitchen_prefs.people.posterior import Posterior
from kitchen_prefs.people.splits import SLIPS
from kitchen_prefs.people.users import LoadingPlan
from kitchen_prefs.people.zones import RACK_OF_ZONE, SINK_ZONE
from kitchen_prefs.preferences import CATEGORIES, RACKS
from kitchen_prefs.simulation.kitchen import FIRST_DISH, RACK_OF_INSTANCE, Kitchen

# How much two dishes are alike that have the same category, material, and so on: what most rules
# of the grammar speak of weighs most.
LIKENESS = {"category": 4, "family": 3, "material": 2, "colour": 1, "greasy": 1, "size": 1}
USUAL = {"overflow": "other side, then other rack", "style": "far left corner"}


@dataclass(frozen=True, eq=False)
class Shown:
    """What readers see of a user's demonstrations.

    Attributes:
        dishes: The dishes of all of them, n.
        zones: Where each of them stands at the end, SINK_ZONE for the sink, (n,) int.
        times: When each was picked in its demonstration, from 0 to 1, (n,) float.
        first: The rack that was loaded first, most often.
        evidence: What each demonstration says to who knows the grammar.
    """

    dishes: DescribedDishes
    zones: np.ndarray
    times: np.ndarray
    first: str
    evidence: tuple[Evidence, ...]

    @cached_property
    def slips(self) -> float:
        """The share of dishes that the user puts elsewhere by mistake, as far as is seen.

        A user whom no rules explain is taken to slip as often as inconsistent users do: nothing
        tells readers which split they are in.
        """
        return 0.0 if Posterior(self.evidence).is_possible else SLIPS

    @cached_property
    def posterior(self) -> Posterior:
        """What who knows the grammar thinks of the user."""
        return Posterior(self.evidence, self.slips)


Yardstick = Callable[[Shown, DescribedDishes], LoadingPlan]


def shown_in(loads: Sequence[tuple[Kitchen, Sequence[int], Evidence]]) -> Shown:
    """What readers see of demonstrations: finished kitchens, their decisions and their evidence."""
    zones, times, firsts = [], [], []
    for kitchen, decisions, _ in loads:
        zones.append(np.minimum(ends_of(kitchen), SINK_ZONE))
        times.append([_time_of(dish, decisions) for dish in range(len(kitchen.location))])
        racks = [RACK_OF_INSTANCE[one] for one in decisions if one in RACK_OF_INSTANCE]
        firsts.append(racks[0] if racks else RACKS[0])
    dishes = [kitchen.dishes for kitchen, *_ in loads]
    assert all(isinstance(one, DescribedDishes) for one in dishes)
    return Shown(
        joined_dishes(dishes),  # type: ignore[arg-type]
        np.concatenate(zones),
        np.concatenate(times),
        Counter(firsts).most_common(1)[0][0],
        tuple(evidence for *_, evidence in loads),
    )


def promptless(shown: Shown, dishes: DescribedDishes) -> LoadingPlan:
    """The most probable user, whatever was shown."""
    return Posterior([]).guess(dishes)


def by_category(shown: Shown, dishes: DescribedDishes) -> LoadingPlan:
    """Each category has the rack in which most of it stands, and is loaded in the order shown."""
    racks = np.array([*(RACKS.index(rack) for rack in RACK_OF_ZONE), len(RACKS)])[shown.zones]
    of_category = _majority(shown.dishes.category, racks, len(CATEGORIES))
    left = np.array([*(RACK_OF_ZONE.index(rack) for rack in RACKS), SINK_ZONE])
    return _plan(shown, dishes, left[of_category][dishes.category])


def by_zone(shown: Shown, dishes: DescribedDishes) -> LoadingPlan:
    """Each category has the zone in which most of it stands, and is loaded in the order shown."""
    of_category = _majority(shown.dishes.category, shown.zones, len(CATEGORIES))
    return _plan(shown, dishes, of_category[dishes.category])


def by_similarity(shown: Shown, dishes: DescribedDishes) -> LoadingPlan:
    """Each dish goes where the most similar one that was shown went, in its turn.

    Of several that are equally similar it is the one that was loaded first.
    """
    likeness = np.zeros((len(dishes.category), len(shown.dishes.category)))
    for name, weight in LIKENESS.items():
        mine, theirs = _values(dishes, name), _values(shown.dishes, name)
        likeness += weight * (mine[:, None] == theirs[None])
    nearest = (likeness - shown.times / 2).argmax(axis=1)  # likeness is a whole number
    return LoadingPlan(shown.zones[nearest], shown.times[nearest], shown.first, **USUAL)


def by_tree(shown: Shown, dishes: DescribedDishes) -> LoadingPlan:
    """A decision tree on the attributes gives the zone, another one the time."""
    from sklearn.tree import DecisionTreeClassifier, DecisionTreeRegressor

    known, asked = _features(shown.dishes), _features(dishes)
    zones = DecisionTreeClassifier(random_state=0).fit(known, shown.zones).predict(asked)
    times = DecisionTreeRegressor(random_state=0).fit(known, shown.times).predict(asked)
    return LoadingPlan(zones, times, shown.first, **USUAL)


def bayes(shown: Shown, dishes: DescribedDishes) -> LoadingPlan:
    """What the exact reader of the grammar thinks most probable."""
    return shown.posterior.guess(dishes)


YARDSTICKS: dict[str, Yardstick] = {
    "promptless": promptless,
    "category": by_category,
    "zone": by_zone,
    "similar": by_similarity,
    "tree": by_tree,
    "bayes": bayes,
}


def _plan(shown: Shown, dishes: DescribedDishes, zones: np.ndarray) -> LoadingPlan:
    """A plan that loads categories in the order of their mean time."""
    count = np.bincount(shown.dishes.category, minlength=len(CATEGORIES))
    total = np.bincount(shown.dishes.category, shown.times, minlength=len(CATEGORIES))
    return LoadingPlan(zones, (total / np.maximum(count, 1))[dishes.category], shown.first, **USUAL)


def _majority(group: np.ndarray, value: np.ndarray, groups: int) -> np.ndarray:
    """The most frequent value of each group, of all where there is none, (groups,) int."""
    most = np.bincount(value).argmax()
    own = (value[group == one] for one in range(groups))
    return np.array([np.bincount(one).argmax() if len(one) else most for one in own])


def _values(dishes: DescribedDishes, name: str) -> np.ndarray:
    return dishes.classes(name) if name in CLASSES else getattr(dishes, name)


def _features(dishes: DescribedDishes) -> np.ndarray:
    """The attributes as a learner takes them, (n, 24)."""
    columns = [
        _values(dishes, scheme)[:, None] == np.arange(len(names))
        for scheme, names in CLASSES.items()
    ]
    return np.hstack([*columns, dishes.greasy[:, None], dishes.extents]).astype(float)


def _time_of(dish: int, decisions: Sequence[int]) -> float:
    picked = FIRST_DISH + dish
    return decisions.index(picked) / len(decisions) if picked in decisions else 1.0
