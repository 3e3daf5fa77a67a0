"""Files of demonstrations: honest ones are replayed, others are refused in a sentence."""

import json
import os
from contextlib import suppress

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from kitchen_prefs import instances
from kitchen_prefs.envs.demonstrations import prompt_of
from kitchen_prefs.preferences import CATEGORIES
from kitchen_prefs.simulation.kitchen import DOOR, SINK
from kitchen_prefs.simulation.sessions import expert_trajectory, make_session
from kitchen_prefs_demonstrations.file_format import (
    parse_demonstration,
    read_demonstration,
    write_demonstration,
)
from kitchen_prefs_demonstrations.kitchens import page_sessions, study_session
from kitchen_prefs_demonstrations.replaying import read_and_replay, replay


def test_a_demonstration_is_replayed_to_its_end(read, content):
    replayed = read(content)
    assert replayed.finished
    assert replayed.file.user == "Ada"
    assert replayed.kinds[0] == "door"
    chosen = replayed.prompt[replayed.prompt[:, instances.CHOSEN] > 0]
    assert len(chosen) == len(content["decisions"])
    assert chosen[:, instances.DECISION].tolist() == list(range(len(chosen)))


def test_the_experts_file_is_the_experts_prompt(read, content):
    session = make_session("prompts", 3)
    decisions = list(expert_trajectory(session).decisions)
    replayed = read(content | {"session": 3, "decisions": decisions})
    assert np.array_equal(replayed.prompt, prompt_of(session))


def test_an_unfinished_demonstration_is_one(read, content):
    replayed = read(content | {"decisions": content["decisions"][:4]})
    assert not replayed.finished
    assert not replayed.frames.success.any()
    assert replayed.frames.done.tolist() == [False, False, False, True]


def test_what_is_written_is_read_again(tmp_path, content):
    demonstration = parse_demonstration(json.dumps(content).encode(), "it")
    write_demonstration(demonstration, tmp_path / "again.json")
    assert read_demonstration(tmp_path / "again.json") == demonstration
    assert [path.name for path in tmp_path.iterdir()] == ["again.json"]


REFUSED = {
    "a refused decision": ({"decisions": [0, 2, 2003]}, "refuses decision 3 .2003.: Only a dish"),
    "an unknown instance": ({"decisions": [0, 2, 23, 2]}, "refuses decision 3"),
    "a place of nowhere": ({"decisions": [0, 2, 3, 1998]}, "refuses decision 4"),
    "a huge number": ({"decisions": [0, 10**30]}, "decisions.1: Input should be less than"),
    "a negative one": ({"decisions": [0, -1]}, "decisions.1"),
    "a fraction": ({"decisions": [0, 1.5]}, "decisions.1"),
    "a truth value": ({"decisions": [True, 2]}, "decisions.0"),
    "no decision": ({"decisions": []}, "at least 1 item"),
    "161 decisions": ({"decisions": [0] * 161}, "at most 160 items"),
    "nothing in a rack": ({"decisions": [0, 2, 2, 0]}, "no dish into a rack"),
    "all in the sink": ({"decisions": [3, SINK]}, "no dish into a rack"),
    "a dish in hand": ({"decisions": [3]}, "ends with a dish in hand"),
    "an unknown split": ({"split": "sene"}, "Did you mean 'seen'"),
    "an unknown session": ({"session": 600}, "has the sessions 0..599, not 600"),
    "another session": ({"session": 401}, "refuses decision"),
    "another data version": ({"data_version": 2}, "is of data version 2, but"),
    "another format": ({"format": 2}, "format: this is format 2, and this release reads 1"),
    "a noisy session": ({"split": "noisy", "session": 3, "decisions": [0]}, "fail at random"),
    "a negative seed": ({"salt": -1}, "salt"),
    "a seed beyond JavaScript": ({"salt": 2**53}, "salt"),
    "HTML in the name": ({"user": "Ada<img src=x onerror=alert(1)>"}, "user: a name has words of"),
    "quotes in the name": ({"user": 'Ada" onload="x'}, "user: a name has words of"),
    "a formula as name": ({"user": "=1+1"}, "user: a name has words of"),
    "colours in the name": ({"user": "Ada\x1b[31m"}, "user: a name has words of"),
    "a name that turns around": ({"user": "Ada\u202e"}, "user: a name has words of"),
    "a name of two scripts": ({"user": "Ad\u0430"}, "several scripts"),
    "a long name": ({"user": "a" * 61}, "at most 60 characters"),
    "an empty name": ({"user": ""}, "user: a name has words of"),
    "a name in a study": (
        {"study": {"name": "s", "participant": "p1", "day": 1}},
        "a participant has a code and no name",
    ),
    "a path as study": (
        {"user": None, "study": {"name": "../s", "participant": "p1", "day": 1}},
        "study.name: it has 1 to 60 letters",
    ),
    "consent in words": ({"consent": "yes"}, "consent"),
    "a secret field": ({"password\x1b[2J": 1}, r"password\?\[2J: Extra inputs are not permitted"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_it_is_refused_in_a_sentence(read, content, case):
    changes, sentence = REFUSED[case]
    with pytest.raises(ValueError, match=sentence) as raised:
        read(content | changes)
    assert "demonstration.json" in str(raised.value)
    assert str(raised.value).isprintable()
    assert len(str(raised.value)) < 500


@pytest.mark.parametrize("name", ["Łukasz", "O\u2019Brien", "Anna-Lena M.", "偏好", "user 7"])
def test_honest_names_are_taken(read, content, name):
    assert read(content | {"user": name}).file.user == name


def test_a_hundred_thousand_decisions_are_not_even_parsed(read, content):
    with pytest.raises(ValueError, match="is larger than 16,384 bytes"):
        read(content | {"decisions": [0] * 100_000})


@pytest.mark.parametrize("text", [b"", b"[", b"null", b"\xff\xfe", b"[" * 10_000, b"NaN", b"{}"])
def test_what_is_no_demonstration_is_refused(read, text):
    with pytest.raises(ValueError, match=r"demonstration\.json does not follow the format"):
        read(text)


def test_links_folders_and_nothing_are_refused(tmp_path):
    (tmp_path / "link.json").symlink_to("/dev/zero")
    os.mkfifo(tmp_path / "pipe")
    sentences = {"link.json": "is a link", "pipe": "not a regular", "": "cannot", "no": "cannot"}
    for name, sentence in sentences.items():
        with pytest.raises(ValueError, match=sentence):
            read_and_replay(tmp_path / name)


def test_decisions_after_the_end_are_refused(read, content):
    with pytest.raises(ValueError, match="is finished before decision"):
        read(content | {"decisions": [*content["decisions"], DOOR]})


def test_more_than_a_prompt_holds_is_refused(read, content):
    with pytest.raises(ValueError, match="is longer than a prompt may be; move the door"):
        read(content | {"decisions": [DOOR, DOOR] * 60 + content["decisions"]})


@settings(max_examples=60, deadline=None)
@given(data=st.data())
def test_an_edited_file_is_replayed_or_refused(content, data):
    decisions = list(content["decisions"])
    for _ in range(data.draw(st.integers(1, 3))):
        at = data.draw(st.integers(0, len(decisions) - 1))
        decisions[at] = data.draw(st.sampled_from([0, 1, 2, *range(3, 18), 999, 1000, 2007, 2400]))
    edited = parse_demonstration(json.dumps(content | {"decisions": decisions}).encode(), "it")
    with suppress(ValueError):
        assert replay(edited, "it").decisions == decisions


def test_the_page_shows_kitchens_of_other_users_with_every_category():
    sessions = page_sessions(20)
    assert len({session.preference for session in sessions}) == 20
    for session in (*sessions, study_session()):
        assert set(session.dishes.category) == set(range(len(CATEGORIES)))
    assert {len(session.dishes.category) for session in sessions} == {12, 14}
    assert len(study_session().dishes.category) == 16
