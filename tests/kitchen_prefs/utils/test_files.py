import json

import numpy as np
import pytest

from kitchen_prefs.utils.files import (
    at_work_alone,
    atomic_file,
    make_folder,
    require_empty,
    write_json,
)


def test_what_is_there_stays_until_the_new_file_is_whole(tmp_path):
    path = tmp_path / "arrays.npz"
    with atomic_file(path) as unfinished:
        np.savez(unfinished, numbers=np.arange(3))
    whole = path.read_bytes()
    with pytest.raises(KeyboardInterrupt):
        write_half(path)
    assert path.read_bytes() == whole
    assert list(tmp_path.iterdir()) == [path]


def write_half(path):
    with atomic_file(path) as unfinished:
        unfinished.write_bytes(b"half")
        raise KeyboardInterrupt


def test_json_is_written_readably(tmp_path):
    write_json(tmp_path / "a.json", {"b": [1]})
    text = (tmp_path / "a.json").read_text()
    assert json.loads(text) == {"b": [1]}
    assert text.endswith("}\n")
    assert len(text.splitlines()) > 1


def test_a_folder_is_made_with_those_above_it(tmp_path):
    make_folder(tmp_path / "a" / "b", "--out")
    make_folder(tmp_path / "a" / "b", "--out")
    assert list((tmp_path / "a" / "b").iterdir()) == []
    (tmp_path / "file").touch()
    with pytest.raises(OSError, match=r"file cannot be written; give another --cards\."):
        make_folder(tmp_path / "file", "--cards")


def test_a_folder_that_holds_something_is_refused(tmp_path):
    require_empty(tmp_path / "new", "--out")
    require_empty(tmp_path, "--out")
    (tmp_path / "file").touch()
    for there in (tmp_path, tmp_path / "file"):
        with pytest.raises(ValueError, match=r"holds something already; give another --out\.$"):
            require_empty(there, "--out")


def test_a_second_command_on_one_folder_is_told(tmp_path):
    out = tmp_path / "out"
    with at_work_alone(out):
        with pytest.raises(ValueError, match=f"at work on {out}; wait until"), at_work_alone(out):
            pass
        with at_work_alone(tmp_path / "other"):
            pass
    with at_work_alone(out):
        pass
