"""A recipe's training steps, as `lerobot-train` makes them, with a timer for each part."""

import time
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import draccus
import torch
from lerobot.configs.train import TrainPipelineConfig
from lerobot.policies import make_policy, make_pre_post_processors
from lerobot.utils.import_utils import register_third_party_plugins
from torch import Tensor
from torch.nn.attention import SDPBackend, sdpa_kernel
from torch.utils.data import DataLoader
from torch.utils.flop_counter import FlopCounterMode

from kitchen_prefs import load_dataset
from kitchen_prefs_experiments.recipes import recipe_file

PARTS = ("data", "pairing", "forward", "backward", "optimiser")


class Training:
    """The training of a recipe, on the recipe's data set and with its loader processes."""

    def __init__(self, recipe: str) -> None:
        register_third_party_plugins()
        config = draccus.decode(TrainPipelineConfig, _settings(recipe))
        dataset = load_dataset(config.dataset.repo_id.removeprefix("kitchen_prefs/"))
        self.batch_size, self.dtype = config.batch_size, config.policy.dtype
        self._policy = make_policy(config.policy, ds_meta=dataset.meta).train()
        self._preprocess, _ = make_pre_post_processors(
            config.policy, dataset_stats=dataset.meta.stats
        )
        loader = DataLoader(
            dataset,
            config.batch_size,
            shuffle=True,
            num_workers=config.num_workers,
            prefetch_factor=config.prefetch_factor,
        )
        self._batches = iter(loader)
        preset = config.policy.get_optimizer_preset()
        optimizer = preset if config.use_policy_training_preset else config.optimizer
        self._optimizer = optimizer.build(self._policy.get_optim_params())
        self._clip = optimizer.grad_clip_norm
        self._seconds: Counter[str] = Counter()
        self._time_pairing()

    def run(self, steps: int) -> int:
        """Make some steps and return their number."""
        for _ in range(steps):
            self._step()
        return steps

    def shares(self) -> dict[str, float]:
        """The parts' shares of all steps so far, in %."""
        seconds = dict(self._seconds)
        seconds["forward"] -= seconds["pairing"]
        total = sum(seconds.values())
        return {part: 100 * seconds[part] / total for part in PARTS}

    def count(self, steps: int) -> tuple[float, float]:
        """Count operations and padding, in some steps that are not timed.

        Args:
            steps: The number of steps.

        Returns:
            The floating-point operations of the matrix products in a step, padding included,
            and the share of padding among the rows of prompts and situations, in %.
        """
        masks = []  # of the tokens that enter encoder and decoder
        network = self._policy.network
        hooks = [
            layers[0].register_forward_pre_hook(lambda _, inputs: masks.append(inputs[0].mask))
            for layers in (network.encoder, network.decoder)
        ]
        # Fused attention on a CPU is not counted; attention by matrix products is.
        with sdpa_kernel(SDPBackend.MATH), FlopCounterMode(display=False) as counter:
            self.run(steps)
        for hook in hooks:
            hook.remove()
        self._seconds.clear()
        real, rows = sum(int(mask.sum()) for mask in masks), sum(mask.numel() for mask in masks)
        return counter.get_total_flops() / steps, 100 * (1 - real / rows)

    def _step(self) -> None:
        with self._timed("data"):
            batch = self._preprocess(next(self._batches))
        with self._timed("forward"), torch.autocast("cpu", enabled=self.dtype == "bfloat16"):
            loss, _ = self._policy(batch)
        with self._timed("backward"):
            loss.backward()
        with self._timed("optimiser"):
            torch.nn.utils.clip_grad_norm_(self._policy.parameters(), self._clip)
            self._optimizer.step()
            self._optimizer.zero_grad()

    @contextmanager
    def _timed(self, part: str) -> Iterator[None]:
        """Add the seconds that pass to a part."""
        start = time.perf_counter()
        yield
        self._seconds[part] += time.perf_counter() - start

    def _time_pairing(self) -> None:
        """Pairing is part of the policy's forward; here it is timed separately."""
        pair = self._policy.pair

        def timed_pairing(batch: dict[str, Tensor]) -> tuple:
            with self._timed("pairing"):
                return pair(batch)

        self._policy.pair = timed_pairing


def _settings(recipe: str) -> dict:
    """A recipe's settings; one that continues a checkpoint starts from random weights instead."""
    with recipe_file(recipe).open() as file:
        settings = draccus.cfgparsing.load_config(file)
    if checkpoint := settings["policy"].pop("path", None):  # outputs/<recipe>/checkpoints/...
        settings["policy"] = _settings(Path(checkpoint).parts[1])["policy"] | settings["policy"]
    return settings
