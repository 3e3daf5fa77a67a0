"""What prompts cost a training: the processor steps beside a whole step of `ttp_quick`."""

from collections.abc import Iterator

import torch
from lerobot.processor.converters import batch_to_transition

from benchmarks.measuring import Result, rates
from benchmarks.steps import Training
from kitchen_prefs import load_dataset
from kitchen_prefs.datasets.prompt_step import PromptStep
from lerobot_policy_kitchen_prefs.common.relabelling_step import RelabellingStep

DATASET = "dishwasher-train-v1"
STEPS = 30  # a round
WHOLE_STEP = ("a whole step of ttp_quick", 100)


def prompt_steps() -> Iterator[Result]:
    training, dataset = Training("ttp_quick"), load_dataset(DATASET)
    prompt, relabelling = PromptStep(dataset.repo_id), RelabellingStep(dataset.repo_id)
    order = torch.randperm(len(dataset), generator=torch.Generator().manual_seed(0))
    frames = order[: training.batch_size].tolist()
    batch = torch.utils.data.default_collate([dataset[i] for i in frames])
    batch = batch_to_transition(batch)
    prompted = prompt(batch)  # reads the data set, once a training
    relabelling(prompted)

    def add_prompts() -> int:
        for _ in range(STEPS):
            prompt(batch)
        return STEPS

    def relabel() -> int:
        for _ in range(STEPS):
            relabelling(prompted)
        return STEPS

    whole, *parts = rates(lambda: training.run(STEPS), add_prompts, relabel)
    for name, rate in zip(("prompts", "relabelling"), parts, strict=True):
        what = f"{name} of a batch of {training.batch_size}"
        yield Result(what, 100 * whole / rate, "% of a step", *WHOLE_STEP)
