"""A policy that acts in a process of its own."""

import json
import os
import signal
import subprocess
import sys
import threading
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from time import monotonic
from typing import Any, Self

import numpy as np

from kitchen_prefs.evaluation.isolation.messages import PipeClosedError, receive, send
from kitchen_prefs.evaluation.isolation.sandbox import scrubbed_environment, start_confined

PROGRAM = "kitchen_prefs.evaluation.isolation.policy_process"
ACTION_BYTES = 7 * 4  # a pose of float32
MOST_SAID = 300  # characters of what its process says


@dataclass(frozen=True)
class Limits:
    """What a policy's process may take.

    Attributes:
        memory: Bytes of data. The CUDA build of torch has 1 GB before a policy is loaded.
        loading: Seconds until the policy is loaded; LeRobot alone takes ten on a busy core.
        decision: Seconds for the actions of one batch.
        average: Seconds for the action of one episode, on average over all of them, so that the
            number of decisions bounds the time of a re-run. Our slowest policy, `ttp_paper`, takes
            0.3 in a batch of its own on a busy core.
    """

    memory: int = 8 * 1024**3
    loading: float = 300.0
    decision: float = 60.0
    average: float = 2.0


class IsolatedPolicy:
    """A policy in a process of its own, for `roll_out`; a context manager that ends the process.

    Args:
        settings: The arguments of `load_policy`, see `policy_settings`.
        log: What the process prints.
        hidden: Folders that the process must not see.
        plugins: A folder of packages that it alone imports from, with the policy's code.
        limits: What it may take.
        seeds: Seeds the policy's random numbers, a number for each batch of episodes; they tell
            nothing of the sessions.

    Attributes:
        type: The policy's type. This and the others are what the process says of its policy: a
            claim that the evaluation cannot prove.
        plugin: The package that it comes from, see `LoadedPolicy`.
        parameters: The number of its weights.
        fingerprint: The hash of its weights and settings.
        track: The track whose observations it receives: the one of the settings, or else its own.

    Raises:
        ValueError: If the policy is not loaded, or does not answer as it must; the message names
            the log.
    """

    def __init__(
        self,
        settings: dict[str, Any],
        log: Path,
        *,
        hidden: Sequence[Path] = (),
        plugins: Path | None = None,
        limits: Limits | None = None,
        seeds: np.random.Generator | None = None,
    ) -> None:
        self._limits = limits or Limits()
        self._seeds = seeds or np.random.default_rng()
        self._log = log
        self._track = settings.get("track")
        self._scratch = TemporaryDirectory(prefix="kitchen_prefs_policy_")
        scratch = Path(self._scratch.name)
        arguments = json.dumps(settings | {"memory": self._limits.memory})
        command = [sys.executable, "-P", "-m", PROGRAM, arguments]
        folders = (settings.get("path"), settings.get("below"), plugins)
        with log.open("ab") as file:
            self._process = start_confined(
                command,
                scratch,
                readable=[Path(folder) for folder in folders if folder],
                hidden=hidden,
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=file,
                env=scrubbed_environment(scratch, plugins),
                start_new_session=True,
            )
        self._seconds_left = self._limits.loading
        try:
            self._introduce()
        except BaseException:
            self.close()
            raise

    def __enter__(self) -> Self:
        """The policy."""
        return self

    def __exit__(self, *_: object) -> None:
        """End the process."""
        self.close()

    def reset(self) -> None:
        """Begin a batch of episodes."""
        with self._answering("begin an episode", self._limits.decision):
            send(self._pipe_in, seed=int(self._seeds.integers(2**31)))

    def act(self, observations: Sequence[dict[str, np.ndarray]], tasks: list[str]) -> np.ndarray:
        """Choose actions for B episodes at once, see `rollouts.Policy`."""
        batch = {name: np.stack([one[name] for one in observations]) for name in observations[0]}
        with self._answering("decide", self._limits.decision):
            self._seconds_left += len(tasks) * self._limits.average
            send(self._pipe_in, batch, tasks=tasks)
            _, arrays = receive(self._pipe_out, ACTION_BYTES * len(tasks))
            actions = arrays.get("actions")
            if actions is None or actions.shape != (len(tasks), 7):
                raise PipeClosedError
        return actions

    def close(self) -> None:
        """End the process."""
        self._kill()
        self._process.wait()
        for pipe in (self._process.stdin, self._process.stdout):
            assert pipe is not None
            with suppress(BrokenPipeError):  # closing flushes, and nobody reads any more
                pipe.close()
        self._scratch.cleanup()

    @property
    def _pipe_in(self) -> Any:
        return self._process.stdin

    @property
    def _pipe_out(self) -> Any:
        return self._process.stdout

    def _introduce(self) -> None:
        with self._answering("load", self._limits.loading):
            head, _ = receive(self._pipe_out, 0)
            if isinstance(head.get("refused"), str):
                raise ValueError(printable(head["refused"]))
            named = [head.get(name) for name in ("type", "fingerprint", "track")]
            plugin = head.get("plugin")
            as_it_must = all(isinstance(n, str) for n in [*named, plugin or ""])
            if not (as_it_must and "parameters" in head):
                raise PipeClosedError
        self._seconds_left = self._limits.decision  # a policy warms up
        self.type, self.fingerprint = head["type"], head["fingerprint"]
        self.parameters, self.track = head["parameters"], self._track or head["track"]
        self.plugin = plugin

    @contextmanager
    def _answering(self, what: str, seconds: float) -> Iterator[None]:
        """The process is ended if it takes too long, and what went wrong is one sentence."""
        late = threading.Event()

        def end() -> None:
            late.set()
            self._kill()

        timer, begun = threading.Timer(seconds, end), monotonic()
        timer.start()
        try:
            yield
        except (PipeClosedError, OSError) as error:
            why = f"took longer than {seconds:g} s to" if late.is_set() else "did not"
            raise ValueError(
                f"The policy {why} {what}; {self._log} has what its process printed."
            ) from error
        finally:
            timer.cancel()
        self._seconds_left -= monotonic() - begun
        if self._seconds_left < 0:
            raise ValueError(
                f"The policy takes more than {self._limits.average:g} s a decision on average; "
                "make it faster."
            )

    def _kill(self) -> None:
        if self._process.poll() is None:
            os.killpg(self._process.pid, signal.SIGKILL)


def printable(text: str) -> str:
    """What a stranger's process says, as a terminal may show it."""
    return "".join(c if c.isprintable() else "?" for c in text[:MOST_SAID])
