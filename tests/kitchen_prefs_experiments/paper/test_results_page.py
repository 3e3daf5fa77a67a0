"""The pages of results: our figures beside the paper's."""

from pathlib import Path

from kitchen_prefs.metrics import Interval
from kitchen_prefs_experiments.paper.paper_tables import TABLES
from kitchen_prefs_experiments.paper.result_files import write_results
from kitchen_prefs_experiments.paper.results_page import pages

ROOT = Path(__file__).parents[3]


def test_a_page_sets_our_figures_beside_the_papers(tmp_path, made_up_results):
    write_results(made_up_results("main"), tmp_path)
    write_results(made_up_results("attributes"), tmp_path)
    written = pages(tmp_path)
    assert "| TTP in the paper | 0.62 | 0.54 | 0.34 | - | - | - |" in written["main"]
    text = written["attributes"]
    assert "| pose, time | 0.40 [0.30, 0.50] | 0.40 [0.30, 0.50] | 0.419 |" in text
    assert "`kitchen-prefs reproduce attributes --budget=32000`" in text
    assert "training from scratch saw 32,000 decisions with the recipe `ttp_quick`" in text
    assert "the trainings took 900 to 900 s each" in text


def test_rows_of_an_earlier_page_are_linked_and_not_repeated(tmp_path, made_up_results):
    write_results(made_up_results("main"), tmp_path)
    write_results(made_up_results("reinforcement"), tmp_path)
    text = pages(tmp_path)["reinforcement"]
    assert "on other pages: [random](main.md), [symbolic](main.md)." in text
    assert "symbolic 0.80" not in text


def test_the_overview_names_what_is_missing_and_takes_the_prose_as_it_is(tmp_path, made_up_results):
    (tmp_path / "prose").mkdir()
    (tmp_path / "prose" / "index.md").write_text("Our kitchen is another one.\n")
    (tmp_path / "prose" / "counts.md").write_text("Ten dishes are *many*.\n")
    write_results(made_up_results("counts"), tmp_path)
    written = pages(tmp_path)
    assert set(written) == {"index", "counts"}
    assert written["index"].startswith("# Results\n\nOur kitchen is another one.\n\n")
    assert "[The number of dishes](counts.md)" in written["index"]
    assert "\n\nTen dishes are *many*.\n\n" in written["counts"]
    missing = written["index"].partition("Not run yet")[2]
    assert {name for name in TABLES if f"`{name}`" in missing} == set(TABLES) - {"counts"}


def test_a_page_says_what_is_done_otherwise_than_in_the_paper(tmp_path, made_up_results):
    write_results(made_up_results("finetuning"), tmp_path)
    write_results(made_up_results("history"), tmp_path)
    written = pages(tmp_path)
    assert "all rows but 0 belong to the open track" in written["finetuning"]
    assert "the trainings took 3 to 900 s each" in written["finetuning"]
    assert "| PE, other prompt on unseen_preferences (70) |" in written["finetuning"]
    assert (
        "trained on all decisions of preference 1 and measured on the picks" in written["history"]
    )


def test_the_committed_pages_are_written_from_the_committed_results():
    folder = ROOT / "docs" / "results"
    committed = {file.stem: file.read_text() for file in folder.glob("*.md")}
    assert committed == pages(folder)


def test_rows_in_which_all_figures_are_equal_become_a_sentence(tmp_path, made_up_results):
    results = made_up_results("main")
    results.rows["random"].groups["seen"].metrics["PE"] = Interval(0.1, 0, 1)
    write_results(results, tmp_path)
    section = pages(tmp_path)["main"].partition("### PE")[2].partition("###")[0]
    assert "| random | 0.10 [0.00, 1.00] | 0.40 [0.30, 0.50] |" in section
    assert "| symbolic |" not in section
    assert "; symbolic 0.80 [0.70, 0.90]; " in section


def test_trainings_that_differ_in_the_seed_have_a_spread(tmp_path, made_up_results):
    results = made_up_results("seeds")
    metrics = results.rows["1"].groups["seen"].metrics
    metrics["Score"] = Interval(0.1, 0.0, 0.2)
    write_results(results, tmp_path)
    text = pages(tmp_path)["seeds"]
    assert "| SD of the seeds | 0.173 | 0.000 |" in text  # of .4, .1 and .4
