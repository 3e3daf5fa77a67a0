"""Rates of work, measured in turn, and how they are reported."""

import statistics
import time
from collections.abc import Callable
from dataclasses import dataclass

from tqdm import tqdm

ROUNDS = 5  # the median of five is robust against one disturbance


@dataclass(frozen=True)
class Result:
    """A rate beside a yardstick's."""

    what: str
    rate: float
    unit: str
    yardstick: str
    yardstick_rate: float

    @property
    def ratio(self) -> float:
        return self.rate / self.yardstick_rate

    def __str__(self) -> str:
        return (
            f"{self.what:46} {self.rate:10,.1f} {self.unit:12} {self.ratio:9.3f} x "
            f"{self.yardstick} ({self.yardstick_rate:,.1f})"
        )


def rates(*works: Callable[[], int]) -> list[float]:
    """Units of work a second, of several works in turn, so that drift hits all of them alike.

    Args:
        *works: Each does some units of work and returns how many.

    Returns:
        The median rate of each work.
    """
    found: list[list[float]] = [[] for _ in works]
    for _ in tqdm(range(ROUNDS), unit="round", leave=False):
        for rate, work in zip(found, works, strict=True):
            start = time.perf_counter()
            units = work()
            rate.append(units / (time.perf_counter() - start))
    return [statistics.median(rate) for rate in found]
