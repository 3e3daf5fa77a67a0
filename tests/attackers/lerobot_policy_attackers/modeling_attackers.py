"""Policies that act with what they find, and print BREACH if they find what they must not."""

import gc
import os
import socket
import sys
from pathlib import Path
from typing import Any

import torch
from lerobot.policies import PreTrainedPolicy

from kitchen_prefs.instances import POSE, choosable
from lerobot_policy_attackers.configuration_attackers import AttackersConfig

OBSERVATIONS = {
    "observation.instances",
    "observation.environment_state",
    "observation.state",
    "observation.prompt",
}


class AttackersPolicy(PreTrainedPolicy):
    """Takes the first row that may be chosen, or one that depends on what it must not know."""

    config_class = AttackersConfig
    name = "attackers"

    def __init__(self, config: AttackersConfig, **_: Any) -> None:
        super().__init__(config)
        self.episodes = 0

    def get_optim_params(self) -> Any: ...
    def forward(self, batch: dict) -> Any: ...
    def predict_action_chunk(self, batch: dict, **_: Any) -> Any: ...

    def reset(self) -> None:
        self.episodes += 1

    def select_action(self, batch: dict, **_: Any) -> torch.Tensor:
        sets = batch["observation.instances"].reshape(-1, 72, 13)  # (B, N, 13)
        if self.config.attack == "peek":
            peek(batch)
        seen = {"peek": 0, "neighbours": len(sets), "memory": self.episodes}[self.config.attack]
        rows = [choosable(one.numpy()).nonzero()[0] for one in sets]
        chosen = [one[row[seen % len(row)], POSE] for one, row in zip(sets, rows, strict=True)]
        return torch.stack(chosen)


def peek(batch: dict) -> None:
    """Look for the session, the expert and the reward wherever a program can look."""
    frame = sys._getframe()
    while frame is not None:
        if {"environments", "session", "sessions", "salt"} & set(frame.f_locals):
            print("BREACH: the stack", frame.f_code.co_name)
        frame = frame.f_back
    kinds = {type(thing) for thing in gc.get_objects()}
    found = [kind.__name__ for kind in kinds if "kitchen_prefs" in str(kind.__module__)]
    if set(found) & {"Session", "Kitchen", "ExpertTrajectory"}:
        print("BREACH: the memory holds", found)
    observed = {key for key in batch if key.startswith("observation.")}
    if observed - OBSERVATIONS or any(batch.get(key) for key in ("info", "next.reward")):
        print("BREACH: the batch holds", batch.keys())
    if any("fresh-" in text for text in [*sys.argv, *os.environ.values()]):
        print("BREACH: the arguments name fresh sessions")
    if len([name for name in os.listdir("/proc") if name.isdigit()]) > 1:
        print("BREACH: other processes are seen")
    if attempt(lambda: Path(__file__).with_name("written").write_text("")):
        print("BREACH: a file was written")
    if attempt(lambda: socket.create_connection(("127.0.0.1", 9), 1)):
        print("BREACH: the network was reached")


def attempt(something: Any) -> bool:
    try:
        something()
    except ConnectionRefusedError:
        return True  # somebody has answered
    except OSError:
        return False
    return True
