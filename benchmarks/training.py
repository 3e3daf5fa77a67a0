"""Training steps a second of TTP beside a matrix product, and the data's share of a step."""

import time
from collections.abc import Callable, Iterator
from itertools import cycle

import draccus
import torch
from lerobot.configs.train import TrainPipelineConfig
from lerobot.policies import make_policy, make_pre_post_processors
from lerobot.utils.import_utils import register_third_party_plugins

from benchmarks.measuring import Result, rates
from kitchen_prefs import load_dataset
from kitchen_prefs.recipes import recipe_file

STEPS = 10  # of training, a round
SIZE = 1024  # of the yardstick's matrices


def training_steps() -> Iterator[Result]:
    register_third_party_plugins()
    config = draccus.parse(TrainPipelineConfig, str(recipe_file("ttp_quick")), args=[])
    dataset = load_dataset("dishwasher-val-v1")
    policy = make_policy(config.policy, ds_meta=dataset.meta)
    preprocess, _ = make_pre_post_processors(config.policy, dataset_stats=dataset.meta.stats)
    loader = torch.utils.data.DataLoader(dataset, batch_size=config.batch_size, shuffle=True)
    batches = cycle(loader)
    optimizer = config.policy.get_optimizer_preset().build(policy.get_optim_params())
    spent = {"data": 0.0, "update": 0.0}

    def timed(part: str, work: Callable):
        start = time.perf_counter()
        result = work()
        spent[part] += time.perf_counter() - start
        return result

    def update(batch: dict) -> None:
        loss, _ = policy.forward(batch)
        loss.backward()
        optimizer.step()
        optimizer.zero_grad()

    def steps() -> int:
        policy.train()
        for _ in range(STEPS):
            batch = timed("data", lambda: preprocess(next(batches)))
            timed("update", lambda batch=batch: update(batch))
        return STEPS

    matrix = torch.randn(SIZE, SIZE)

    def products() -> int:
        for _ in range(10):
            matrix @ matrix
        return 10

    rate, yardstick = rates(steps, products)
    name = f"TTP, recipe ttp_quick, batches of {config.batch_size}"
    share = 100 * spent["data"] / sum(spent.values())
    yield Result(name, rate, "steps/s", f"products of {SIZE} x {SIZE} matrices", yardstick)
    yield Result("  of which data", share, "% of a step", "the whole step", 100)
