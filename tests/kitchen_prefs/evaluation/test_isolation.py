"""A policy's process: what it cannot see, and what happens when it does not behave."""

import io
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from act_checkpoints import call
from hypothesis import given
from hypothesis import strategies as st

from kitchen_prefs.envs.environment import DishwasherLoading
from kitchen_prefs.evaluation.episode_files import read_episodes
from kitchen_prefs.evaluation.isolation import isolated_policy
from kitchen_prefs.evaluation.isolation.isolated_policy import IsolatedPolicy, Limits
from kitchen_prefs.evaluation.isolation.messages import PipeClosedError, receive, send
from kitchen_prefs.evaluation.isolation.sandbox import has_sandbox
from kitchen_prefs.evaluation.policy_loading import load_policy
from kitchen_prefs.evaluation.rollouts import roll_out
from kitchen_prefs.metrics import packing_efficiency

ATTACKERS = Path(__file__).parents[2] / "attackers"
SYMBOLIC = {"policy_type": "rules", "options": ["--rule=symbolic"], "track": "standard"}
needs_sandbox = pytest.mark.skipif(not has_sandbox(), reason="needs bubblewrap")
LIMITS = Limits(memory=1024**3, loading=20, decision=2)


@pytest.fixture
def attackers(monkeypatch):
    monkeypatch.setenv("PYTHONPATH", str(ATTACKERS))


@pytest.fixture
def hostile(attackers, monkeypatch, tmp_path):
    """Starts a process that misbehaves in some way, and begins an episode."""
    monkeypatch.setattr(isolated_policy, "PROGRAM", "hostile_process")
    observation, _ = DishwasherLoading("val").reset(seed=0)

    def start(behaviour, limits=LIMITS):
        settings = {"policy_type": behaviour}
        with IsolatedPolicy(settings, tmp_path / "log", limits=limits) as policy:
            policy.reset()
            return policy.act([observation], [""])

    return start


@pytest.mark.parametrize(
    ("behaviour", "sentence"),
    [
        ("lies", "The policy did not load"),
        ("floods", "The policy did not load"),
        ("sleeps", "The policy took longer than 2 s to decide"),
        ("exits", "The policy did not decide"),
        ("hoards", "The policy did not decide"),
        ("huge", "The policy did not decide"),
        ("prints", "The policy did not decide"),
        ("small", "The policy did not decide"),
    ],
)
def test_a_process_that_misbehaves_is_one_sentence(hostile, tmp_path, behaviour, sentence):
    with pytest.raises(ValueError, match=f"^{sentence}; {tmp_path / 'log'} has what its process"):
        hostile(behaviour)


def test_a_process_that_never_loads_is_ended(hostile):
    with pytest.raises(ValueError, match="took longer than 3 s to load"):
        hostile("silent", Limits(memory=1024**3, loading=3, decision=2))


def test_a_process_that_dawdles_is_ended_before_long(attackers, monkeypatch, tmp_path):
    monkeypatch.setattr(isolated_policy, "PROGRAM", "hostile_process")
    limits = Limits(memory=1024**3, loading=20, decision=1, average=0.05)
    batches = []

    def decide(policy):
        for _ in range(100):
            policy.act([{}], [""])
            batches.append(1)

    with (
        IsolatedPolicy({"policy_type": "dawdles"}, tmp_path / "log", limits=limits) as policy,
        pytest.raises(ValueError, match=r"takes more than 0\.05 s a decision on average"),
    ):
        decide(policy)
    assert len(batches) < 20


@pytest.mark.lerobot
def test_a_policy_decides_in_its_process_as_in_this_one(tmp_path):
    with IsolatedPolicy(SYMBOLIC, tmp_path / "log") as policy:
        isolated = roll_out(policy, "val", sessions=range(4))
    here = load_policy(**SYMBOLIC)
    assert (policy.type, policy.fingerprint) == (here.type, here.fingerprint)
    assert [e.decisions for e in isolated] == [
        e.decisions for e in roll_out(here, "val", sessions=range(4))
    ]


@pytest.mark.lerobot
@needs_sandbox
def test_a_policy_that_looks_for_the_expert_finds_nothing(attackers, tmp_path):
    settings = {"policy_type": "attackers", "options": ["--attack=peek"], "track": "standard"}
    kept = tmp_path / "fresh-12345"
    kept.mkdir()
    with IsolatedPolicy(settings, kept / "log", hidden=[tmp_path]) as policy:
        episodes = roll_out(policy, "val", sessions=range(2))
    said = (kept / "log").read_text()
    assert "BREACH" not in said
    assert all(packing_efficiency(episode) < 0.5 for episode in episodes)
    assert not list(ATTACKERS.rglob("written"))


@pytest.mark.lerobot
def test_evaluate_untrusted_gives_the_episodes_of_evaluate(few_sessions, tmp_path):
    rule = ("--policy.type=rules", "--policy.rule=nearest")
    for name, options in (("here", ()), ("isolated", ("--untrusted",))):
        result = call("evaluate", "--split=val", f"--out={tmp_path / name}", *rule, *options)
        assert result.exit_code == 0
    here, isolated = (read_episodes(tmp_path / name / "val.jsonl") for name in ("here", "isolated"))
    assert here == isolated
    arguments = ("--split=val", f"--out={tmp_path / 'x'}", "--untrusted", "--policy.a=1")
    with pytest.raises(ValueError, match=r"^The policy has no setting 'a'"):
        call("evaluate", *rule, *arguments)


@needs_sandbox
def test_its_process_ends_with_this_one_even_while_it_sleeps(attackers, tmp_path):
    program = f"""
from pathlib import Path
from kitchen_prefs.evaluation.isolation import isolated_policy
isolated_policy.PROGRAM = "hostile_process"
settings = {{"policy_type": "sleeps", "options": [{str(tmp_path)!r}]}}
policy = isolated_policy.IsolatedPolicy(settings, Path({str(tmp_path / "log")!r}))
policy.reset()
print("asleep", flush=True)
policy.act([dict()], [""])
"""
    with subprocess.Popen(
        [sys.executable, "-c", program], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL
    ) as parent:
        assert parent.stdout is not None
        parent.stdout.readline()
        assert _processes_that_name(tmp_path)
        parent.send_signal(signal.SIGKILL)
    for _ in range(100):
        if not _processes_that_name(tmp_path):
            return
        time.sleep(0.1)
    raise AssertionError("the policy's process goes on")


def _processes_that_name(folder):
    """The processes with a folder among their arguments, inside and outside of the sandbox."""
    listed = subprocess.run(
        ["ps", "-ww", "-eo", "args"], capture_output=True, text=True, check=True
    )
    return [line for line in listed.stdout.splitlines() if f'"options": ["{folder}"]' in line]


@given(st.binary(max_size=200))
def test_what_is_no_message_is_refused(content):
    with pytest.raises(PipeClosedError):
        receive(io.BytesIO(content), most=100)


@given(st.integers(1, 4), st.text(max_size=20))
def test_a_message_arrives_as_it_was_sent(batch, task):
    pipe, actions = io.BytesIO(), np.random.default_rng(batch).random((batch, 7), np.float32)
    send(pipe, {"actions": actions}, tasks=[task] * batch)
    pipe.seek(0)
    head, arrays = receive(pipe, most=actions.nbytes)
    assert head == {"tasks": [task] * batch}
    np.testing.assert_array_equal(arrays["actions"], actions)
    pipe.seek(0)
    with pytest.raises(PipeClosedError):
        receive(pipe, most=actions.nbytes - 1)
