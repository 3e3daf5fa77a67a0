"""The files of results: read as they were written, and the committed ones."""

from pathlib import Path

import pytest

from kitchen_prefs_experiments.paper.paper_tables import TABLES
from kitchen_prefs_experiments.paper.result_files import read_results, write_results

RESULTS = Path(__file__).parents[3] / "docs" / "results"


def test_damaged_results_are_named(tmp_path):
    (tmp_path / "main.json").write_text('{"table": ')
    with pytest.raises(ValueError, match=r"main\.json is damaged; `kitchen-prefs reproduce main`"):
        read_results(tmp_path)


def test_the_committed_results_are_those_of_the_tables():
    for name, results in read_results(RESULTS).items():
        assert list(results.rows) == list(TABLES[name].rows)
        assert (RESULTS / f"{name}.png").exists()


def test_the_committed_results_are_written_as_they_were_read(tmp_path):
    for name, results in read_results(RESULTS).items():
        write_results(results, tmp_path)
        file = f"{name}.json"
        assert (tmp_path / file).read_bytes() == (RESULTS / file).read_bytes()


@pytest.mark.parametrize("content", ["[]", "{}", '{"table": "main", "rows": 3}'])
def test_results_of_another_structure_are_named(tmp_path, content):
    (tmp_path / "main.json").write_text(content)
    with pytest.raises(ValueError, match=r"main\.json is damaged"):
        read_results(tmp_path)
