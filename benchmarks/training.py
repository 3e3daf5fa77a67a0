"""Training steps of each TTP recipe: their parts, and their arithmetic beside matrix products."""

from collections.abc import Callable, Iterator

import torch

from benchmarks.measuring import Result, rates
from benchmarks.steps import Training

# Steps a round: many beside the batches that the loader has ready, few where a step takes seconds.
STEPS = {"ttp_quick": 30, "ttp_plus": 30, "ttp_paper": 2}
SIZE = 1024  # of the yardstick's matrices
PRODUCTS = 10  # a round
WHOLE_STEP = ("the whole step", 100)


def training_steps() -> Iterator[Result]:
    for recipe, steps in STEPS.items():
        yield from _training(recipe, steps)


def _training(recipe: str, steps: int) -> Iterator[Result]:
    training = Training(recipe)
    size, padding = training.count(steps)
    dtypes = dict.fromkeys(("float32", training.dtype))
    rate, *products = rates(lambda: training.run(steps), *map(_products, dtypes))
    what = f"TTP, recipe {recipe}, batches of {training.batch_size}"
    yield Result(what, rate, "steps/s", f"products of {SIZE} x {SIZE} matrices", products[0])
    for dtype, product in zip(dtypes, products, strict=True):
        reached = 2 * SIZE**3 * product / 1e9
        yield Result("  arithmetic", rate * size / 1e9, "GFLOP/s", f"{dtype} products", reached)
    shares = training.shares()
    for part, share in shares.items():
        yield Result(f"  of which {part}", share, "% of a step", *WHOLE_STEP)
    yield Result("  rows that are padding", padding, "%", "all rows", 100)
    wasted = shares["data"] + padding / 100 * (shares["forward"] + shares["backward"])
    yield Result("  data and padding together", wasted, "% of a step", *WHOLE_STEP)


def _products(dtype: str) -> Callable[[], int]:
    matrix = torch.randn(SIZE, SIZE, dtype=getattr(torch, dtype))

    def products() -> int:
        for _ in range(PRODUCTS):
            matrix @ matrix
        return PRODUCTS

    return products
