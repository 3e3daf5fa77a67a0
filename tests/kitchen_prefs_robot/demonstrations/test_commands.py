import pytest

pytest.importorskip("gym_hil", reason="needs the extra `robot`")

import pyarrow as pa
import pyarrow.parquet as pq
from typer.testing import CliRunner

from kitchen_prefs_robot.commands import app
from kitchen_prefs_robot.demonstrations.storage import COLUMNS


def refusal(*arguments):
    result = CliRunner().invoke(app, list(map(str, arguments)))
    assert isinstance(result.exception, (ValueError, OSError))
    return str(result.exception)


def test_a_preference_that_there_is_not_is_refused_before_anything_is_recorded(tmp_path):
    out = tmp_path / "out"
    assert "no preference 9" in refusal("demonstrate", "--scene=1", "--preference=9", "--out", out)
    assert not out.exists()


def test_a_folder_that_holds_something_is_left_alone(tmp_path):
    (tmp_path / "mine").touch()
    assert "give another --out" in refusal(
        "demonstrate", "--scene=1", "--preference=0", "--out", tmp_path
    )
    assert [path.name for path in tmp_path.iterdir()] == ["mine"]


@pytest.mark.parametrize("columns", [("x",), COLUMNS])
def test_a_foreign_data_set_is_one_sentence(tmp_path, columns):
    file = tmp_path / "data" / "chunk-000" / "file-000.parquet"
    file.parent.mkdir(parents=True)
    pq.write_table(pa.table({column: [1] for column in columns}), file)
    assert "is damaged or no data set of these" in refusal("verify", "--root", tmp_path)
