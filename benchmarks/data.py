"""Making data sets beside LeRobot's own writer, and its loader beside plain indexing."""

import os
import shutil
import tempfile
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import torch
from lerobot.datasets import LeRobotDataset

from benchmarks.measuring import Result, rates
from kitchen_prefs import load_dataset
from kitchen_prefs.datasets.columns import FEATURES, FPS, columns_of
from kitchen_prefs.datasets.names import content_of
from kitchen_prefs.datasets.writing import write_dataset
from kitchen_prefs.envs.demonstrations import demonstrate
from kitchen_prefs.simulation.sessions import make_session

EPISODES = 70  # dishwasher-val-v1
BY_LEROBOT = 10  # episodes for LeRobot's writer, which takes a second for ten
SAMPLES = 500


def making_episodes() -> Iterator[Result]:
    folder = Path(tempfile.mkdtemp())

    def ours() -> int:
        write_dataset(content_of("dishwasher-val-v1"), folder / "ours", None)
        shutil.rmtree(folder / "ours")
        return EPISODES

    def lerobots() -> int:
        dataset = LeRobotDataset.create("kitchen_prefs/x", FPS, FEATURES, folder / "lerobots")
        for i in range(BY_LEROBOT):
            demonstration = demonstrate(make_session("val", i))
            columns = columns_of(demonstration)
            for t in range(len(demonstration.done)):
                frame = {name: np.atleast_1d(columns[name][t]) for name in FEATURES}
                dataset.add_frame({**frame, "task": demonstration.task})
            dataset.save_episode()
        dataset.finalize()
        shutil.rmtree(folder / "lerobots")
        return BY_LEROBOT

    rate, yardstick = rates(ours, lerobots)
    shutil.rmtree(folder)
    name = f"making a data set, {os.cpu_count()} cores"
    yield Result(name, rate, "episodes/s", "add_frame and save_episode", yardstick)


def loader_samples() -> Iterator[Result]:
    dataset = load_dataset("dishwasher-val-v1")
    order = np.random.default_rng(0).permutation(len(dataset))[:SAMPLES].tolist()
    column = torch.from_numpy(np.stack(dataset.hf_dataset["observation.instances"]))

    def loader() -> int:
        for i in order:
            dataset[i]
        return SAMPLES

    def indexing() -> int:
        for i in order:
            column[i].clone()
        return SAMPLES

    rate, yardstick = rates(loader, indexing)
    yield Result("LeRobot's loader", rate, "samples/s", "indexing an array", yardstick)
