"""Committed checkpoints, trained further with LeRobot's defaults, do not forget what they know."""

import json
from itertools import islice
from pathlib import Path

import draccus
import pytest
import torch
from lerobot.configs import PreTrainedConfig
from lerobot.configs.default import DatasetConfig
from lerobot.configs.train import TrainPipelineConfig
from lerobot.datasets import make_dataset
from lerobot.optim import LRSchedulerConfig, OptimizerConfig
from lerobot.optim.factory import make_optimizer_and_scheduler
from lerobot.policies import make_policy, make_pre_post_processors
from lerobot.utils.import_utils import is_package_available
from torch.utils.data import DataLoader

import kitchen_prefs.datasets

CHECKPOINTS = sorted((Path(__file__).parents[2] / "policies/checkpoints").glob("*/config.json"))
DATASET = "dishwasher-train-p7-d6-v1"
STEPS, BATCH_SIZE = 30, 8  # LeRobot's default batch size
FEW_STEPS = 8  # of a policy that takes seconds for one
LEROBOTS = ("act", "diffusion")


@pytest.fixture(scope="session")
def data_root(made_once):
    def fill(folder):
        with pytest.MonkeyPatch.context() as patch:
            patch.setenv("HF_LEROBOT_HOME", str(folder))
            kitchen_prefs.datasets.make_dataset(DATASET)

    return made_once("fine_tuning_data", fill) / "kitchen_prefs" / DATASET


@pytest.mark.slow
@pytest.mark.parametrize("folder", [file.parent for file in CHECKPOINTS], ids=lambda f: f.name)
def test_default_steps_at_most_double_the_loss_on_a_fixed_batch(folder, data_root):
    config = PreTrainedConfig.from_pretrained(folder)
    if config.type == "diffusion" and not is_package_available("diffusers"):
        pytest.skip("needs the extra diffusion")
    config.pretrained_path = folder
    data = DatasetConfig(f"kitchen_prefs/{DATASET}", root=str(data_root))
    steps = FEW_STEPS if folder.name == "ttp_paper" else STEPS
    training = TrainPipelineConfig(data, policy=config, steps=steps, batch_size=BATCH_SIZE)
    training.optimizer = config.get_optimizer_preset()
    training.scheduler = config.get_scheduler_preset()
    dataset = make_dataset(training)
    policy = make_policy(config, ds_meta=dataset.meta)
    preprocess, _ = make_pre_post_processors(config, str(folder))
    torch.manual_seed(0)
    loader = DataLoader(dataset, BATCH_SIZE, shuffle=True, drop_last=True)
    fixed, *batches = map(preprocess, islice(loader, 1 + steps))

    before = loss_of(policy, fixed)
    train(policy, batches, training)
    assert loss_of(policy, fixed) <= 2 * before


@pytest.mark.parametrize("folder", [file.parent for file in CHECKPOINTS], ids=lambda f: f.name)
def test_the_preset_is_what_trained_it_at_a_tenth_of_the_learning_rate(folder):
    if not (folder / "train_config.json").is_file() or folder.name in LEROBOTS:
        pytest.skip("trained by PPO, or LeRobot's own preset trained it")
    trained = json.loads((folder / "train_config.json").read_text())
    config = PreTrainedConfig.from_pretrained(folder)
    trained_by, preset = trained["optimizer"], draccus.encode(config.optimizer, OptimizerConfig)
    # ttp_plus went on from ttp_quick, and its preset is ttp_quick's.
    rate = 5e-5 if folder.name == "ttp_plus" else trained_by["lr"] / 10
    assert preset["lr"] == pytest.approx(rate)
    assert preset | {"lr": 0} == trained_by | {"lr": 0}
    if trained["scheduler"]:
        assert draccus.encode(config.scheduler, LRSchedulerConfig) == trained["scheduler"]


def loss_of(policy, batch):
    """The loss on a batch; every call draws the same noise."""
    policy.eval()
    torch.manual_seed(0)
    with torch.no_grad():
        return policy.forward(batch)[0].item()


def train(policy, batches, training):
    """Train as lerobot-train does."""
    optimizer, scheduler = make_optimizer_and_scheduler(training, policy)
    policy.train()
    for batch in batches:
        with torch.autocast("cpu", enabled=getattr(policy.config, "dtype", "") == "bfloat16"):
            loss, _ = policy.forward(batch)
        loss.backward()
        limit = training.optimizer.grad_clip_norm
        torch.nn.utils.clip_grad_norm_(policy.parameters(), limit)
        optimizer.step()
        optimizer.zero_grad()
        if scheduler:
            scheduler.step()
