import pytest

pytest.importorskip("gym_hil", reason="needs the extra `robot`")

from typer.testing import CliRunner

from kitchen_prefs_robot.commands import app


def refusal(*arguments):
    result = CliRunner().invoke(app, ["demonstrate", *map(str, arguments)])
    assert isinstance(result.exception, (ValueError, OSError))
    return str(result.exception)


def test_a_preference_that_there_is_not_is_refused_before_anything_is_recorded(tmp_path):
    out = tmp_path / "out"
    assert "no preference 9" in refusal("--scene=1", "--preference=9", "--out", out)
    assert not out.exists()


def test_a_folder_that_holds_something_is_left_alone(tmp_path):
    (tmp_path / "mine").touch()
    assert "give another --out" in refusal("--scene=1", "--preference=0", "--out", tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["mine"]
