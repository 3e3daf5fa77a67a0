"""The page of results: our figures beside the paper's."""

from pathlib import Path

from kitchen_prefs_experiments.paper.paper_tables import TABLES
from kitchen_prefs_experiments.paper.result_files import write_results
from kitchen_prefs_experiments.paper.results_page import report

ROOT = Path(__file__).parents[3]


def test_the_report_sets_our_figures_beside_the_papers(tmp_path, made_up_results):
    write_results(made_up_results("main"), tmp_path)
    write_results(made_up_results("attributes"), tmp_path)
    text = report(tmp_path)
    assert "| TTP, ttp_plus | 0.40 [0.30, 0.50], 50% |" in text
    assert "| symbolic | 0.80 [0.70, 0.90], 100% |" in text
    assert "| TTP in the paper | 0.62 | 0.54 | 0.34 | - | - | - |" in text
    assert "| pose, time | 0.40 [0.30, 0.50] | 0.40 [0.30, 0.50] | 0.419 |" in text
    assert "`kitchen-prefs reproduce attributes --budget=32000`" in text
    assert "training from nothing saw 32,000 decisions with the recipe `ttp_quick`" in text
    assert "the trainings took 900 to 900 s each" in text


def test_the_report_names_what_is_missing_and_takes_the_prose_as_it_is(tmp_path, made_up_results):
    (tmp_path / "introduction.md").write_text("Our kitchen is another one.\n")
    (tmp_path / "counts.md").write_text("Ten dishes are *many*.\n")
    write_results(made_up_results("counts"), tmp_path)
    text = report(tmp_path)
    assert text.startswith("# Results\n\nOur kitchen is another one.\n\n")
    assert "\n\nTen dishes are *many*.\n\n" in text
    missing = text.partition("## Not there yet")[2]
    assert {name for name in TABLES if f"`{name}`" in missing} == set(TABLES) - {"counts"}


def test_the_report_says_what_is_done_otherwise_than_in_the_paper(tmp_path, made_up_results):
    write_results(made_up_results("finetuning"), tmp_path)
    write_results(made_up_results("history"), tmp_path)
    text = report(tmp_path)
    assert "all rows but 0 belong to the open track" in text
    assert "the trainings took 3 to 900 s each" in text
    assert "trained on all decisions of preference 1 and measured on the picks" in text
    assert "| PE, other prompt on unseen_preferences (70) |" in text


def test_the_committed_report_is_written_from_the_committed_results():
    assert (ROOT / "docs" / "RESULTS.md").read_text() == report(ROOT / "docs" / "results")
