"""The exact posterior over all 2 x 7! preferences, given a prompt, a session's dishes, or both.

The prior is uniform. A preference explains a prompt or it does not, because the expert is
deterministic. The dishes of a session are informative even without a prompt: as many of them belong
to the top rack as to the bottom rack (see `kitchen_prefs.simulation.sessions`), so the frequencies
of the categories show which ones are likely to share a rack.
"""

from functools import lru_cache
from math import comb, perm

import numpy as np

from kitchen_prefs import instances
from kitchen_prefs.preferences import CATEGORIES, RACKS, SPACE_SIZE, Preference
from kitchen_prefs.splits import OTHER_COUNTS, TRAINING_COUNTS
from lerobot_policy_kitchen_prefs.rules.observed_view import Memory, ObservedView
from lerobot_policy_kitchen_prefs.rules.preference_inference import decisions_of
from lerobot_policy_kitchen_prefs.rules.preference_space import expert_choices, preference_space

# The possible numbers of dishes per rack; they are assumed to be equally likely, because an
# observation does not contain the number.
COUNTS = sorted(TRAINING_COUNTS + OTHER_COUNTS)
TOP, BOTTOM = RACKS.index("top"), RACKS.index("bottom")


class PosteriorInference:
    """Infers the preference of one episode before each decision.

    Args:
        prior: The prior before the session, (P,), up to a factor.
    """

    def __init__(self, prior: np.ndarray) -> None:
        self._prior = prior
        self._present = 0
        self._stowed = np.zeros(len(CATEGORIES), dtype=int)
        self._held: str | None = None

    def __call__(self, view: ObservedView) -> Preference:
        """The preference to act by.

        Args:
            view: The view before the next decision.
        """
        dishes = self._dishes_so_far(view)
        likelihood = session_likelihood(tuple(dishes.tolist()), self._present)
        posterior = self._prior * likelihood[preference_space().partition]  # (P,)
        # The prompt of another preference may contradict the session; then only the prompt counts.
        return best_preference(posterior if posterior.any() else self._prior, dishes)

    def _dishes_so_far(self, view: ObservedView) -> np.ndarray:
        """The dishes of each category that have arrived, (7,): those waiting and those put away."""
        if self._held is not None and view.held is None:
            self._stowed[CATEGORIES.index(self._held)] += 1
        self._held = view.held
        waiting = [CATEGORIES.index(option.category) for option in view.waiting()]
        self._present = self._present or len(waiting)
        return self._stowed + np.bincount(waiting, minlength=len(CATEGORIES))


def uniform_prior() -> np.ndarray:
    """Every preference is equally likely, (P,)."""
    return np.ones(SPACE_SIZE)


def prompt_likelihood(prompt: np.ndarray) -> np.ndarray:
    """1 for each preference under which the expert acts as in a prompt, else 0.

    If noisy observations leave none that explains every decision, those that explain most count.

    Args:
        prompt: (R, 14), padded; of several demonstrations, one below the other, all count.

    Returns:
        (P,) float.
    """
    explained = np.zeros(SPACE_SIZE, dtype=int)
    memory = Memory()
    for rows, chosen in decisions_of(prompt):
        if rows[0, instances.DECISION] == 0:
            memory = Memory()
        explained += expert_choices(ObservedView(rows, memory)) == chosen
    return (explained == explained.max()).astype(float)


def best_preference(posterior: np.ndarray, dishes: np.ndarray) -> Preference:
    """The preference to act by under a posterior.

    The racks of the categories are those of the best expected packing efficiency, the first rack is
    the more probable one, and each rack is loaded in the order of the expected ranks.

    Args:
        posterior: (P,), up to a factor.
        dishes: The number of dishes of each category that have arrived, (7,).
    """
    space = preference_space()
    posterior = posterior / posterior.sum()
    of_partition = np.bincount(space.partition, posterior)  # (35,)
    racks = space.partitions[(_packing(dishes) @ of_partition).round(9).argmax()]  # (7,)
    first = np.bincount(space.first, posterior, minlength=len(RACKS)).round(9).argmax()
    ranks = (posterior @ space.rank).round(9)  # (7,); rounded, so that ties are ties everywhere
    order = np.argsort(ranks, kind="stable")
    top, bottom = (
        tuple(CATEGORIES[c] for c in order if racks[c] == rack) for rack in (TOP, BOTTOM)
    )
    return Preference(RACKS[first], top, bottom)


def _packing(dishes: np.ndarray) -> np.ndarray:
    """PE of loading by one partition under another one, (35, 35)."""
    packed = []
    for rack in (TOP, BOTTOM):
        loaded = (preference_space().partitions == rack).astype(float)  # (35, 7)
        wanted = loaded @ dishes  # (35,)
        right = (loaded * dishes) @ loaded.T  # (35, 35)
        packed.append(np.where(wanted > 0, right / np.maximum(wanted, 1), 1.0))
    return np.mean(packed, axis=0)


@lru_cache(maxsize=4096)
def session_likelihood(dishes: tuple[int, ...], present: int) -> np.ndarray:
    """The likelihood of a session's first dishes under each partition of the categories.

    Args:
        dishes: The number of dishes of each category that have arrived, (7,).
        present: The number of dishes on the counter at the start.

    Returns:
        (35,) float, up to a factor.
    """
    partitions = preference_space().partitions
    return np.array([_of_partition(np.array(dishes), racks, present) for racks in partitions])


def _of_partition(dishes: np.ndarray, racks: np.ndarray, present: int) -> float:
    """The likelihood if each category belongs to a given rack, (7,)."""
    top, bottom = dishes[racks == TOP].tolist(), dishes[racks == BOTTOM].tolist()
    return sum(
        _probability_of_start(present, count)
        * _probability_of_racks(sum(top), sum(bottom), count)
        * _probability_of_dishes(top, count)
        * _probability_of_dishes(bottom, count)
        for count in COUNTS
    )


def _probability_of_start(present: int, count: int) -> float:
    """The probability of `present` dishes at the start: uniform between half and all, rounded."""
    if not count <= present <= 2 * count:
        return 0.0
    return (0.5 if present in (count, 2 * count) else 1.0) / count


def _probability_of_racks(top: int, bottom: int, count: int) -> float:
    """The probability of the first dishes' racks, of `count` per rack in random order."""
    if max(top, bottom) > count:
        return 0.0
    return comb(2 * count - top - bottom, count - top) / comb(2 * count, count)


def _probability_of_dishes(dishes: list[int], count: int) -> float:
    """The probability of the first dishes of one rack, one after the other.

    A rack has one dish of each of its K categories, as far as `count` goes, and N more that are
    drawn uniformly from them. Let X_k of these be of category k, and c_k the dishes so far. The
    probability is E[prod_k (1 + X_k)_{c_k}] / (count)_{sum c}, where (x)_n is the falling
    factorial. Since (1 + x)_c = (x)_c + c (x)_{c-1} and, for the multinomial distribution,
    E[prod_k (X_k)_{n_k}] = (N)_{sum n} / K^{sum n}, it is a sum over the elementary symmetric
    polynomials of c.
    """
    categories, so_far = len(dishes), sum(dishes)
    if so_far > count or (count < categories and max(dishes) > 1):
        return 0.0
    if count < categories:  # no category twice
        return 1 / perm(categories, so_far)
    polynomials = np.poly(-np.array(dishes)).tolist()  # e_0(c), ..., e_K(c)
    ways = sum(
        polynomial * perm(count - categories, so_far - once) / categories ** (so_far - once)
        for once, polynomial in enumerate(polynomials[: so_far + 1])
    )
    return ways / perm(count, so_far)
