"""The paper's tables: what they train, what is kept, what the report says."""

import json
import shutil
from concurrent.futures import ThreadPoolExecutor
from dataclasses import fields
from pathlib import Path

import numpy as np
import pytest
import yaml
from lerobot.configs import PreTrainedConfig
from lerobot.utils.import_utils import register_third_party_plugins
from PIL import Image
from typer.testing import CliRunner

from kitchen_prefs.cli import command_line
from kitchen_prefs.datasets.names import content_of
from kitchen_prefs.utils.processes import run_module
from kitchen_prefs_experiments.paper import paper_tables, table_runner, training
from kitchen_prefs_experiments.paper.evaluated_policies import (
    RECIPE,
    Committed,
    FineTuning,
    Rule,
    Training,
)
from kitchen_prefs_experiments.paper.figures import COLOURS, draw
from kitchen_prefs_experiments.paper.paper_tables import TABLES, get_table
from kitchen_prefs_experiments.paper.result_files import read_facts, write_facts
from kitchen_prefs_experiments.paper.results_page import pages
from kitchen_prefs_experiments.paper.rows import BASE
from kitchen_prefs_experiments.paper.table_types import Table
from kitchen_prefs_experiments.paper.training import seconds_of, train
from kitchen_prefs_experiments.recipes import recipe_file

ROOT = Path(__file__).parents[3]
LOGGED = "INFO 2026-01-01 00:00:00 step:{} loss:2.1 updt_s:0.400 data_s:0.100 smp/s:310\n"
# A small TTP, so that a step takes milliseconds.
SMALL = ("--policy.dim_pose=16", "--policy.dim_extents=8", "--policy.dim_time=4", "--num_workers=0")


def run(*arguments):
    return CliRunner().invoke(command_line(), list(map(str, arguments)))


# All but those of learning curves.
POLICY_TABLES = {name: table for name, table in TABLES.items() if isinstance(table, Table)}


def trainings():
    policies = [policy for table in POLICY_TABLES.values() for policy in table.policies]
    return [policy for policy in policies if isinstance(policy, Training)]


def seconds_of_row(policy):
    """As the facts keep them: of a fine-tuning a few seconds for each of its trainings."""
    match policy:
        case Training():
            return {"seconds": 900}
        case FineTuning():
            return {"policies": [{"seconds": 3 + n} for n, _ in enumerate(policy.trainings)]}
    return {}


def made_up_facts(name, mean=0.4):
    """The facts of a table in which every mean is the same, and the symbolic rule's 0.8."""
    table = TABLES[name]
    rows = {}
    for label, policy in table.rows.items():
        value = 0.8 if label == "symbolic" else mean
        interval = {"mean": value, "low": value - 0.1, "high": value + 0.1}
        groups = {
            group: {
                "episodes": 70,
                "metrics": {
                    metric: interval
                    for metric in table.metrics
                    if metric != "Prompt use" or group in table.prompt_use
                },
            }
            for group in table.groups
        }
        rows[label] = {"groups": groups, **seconds_of_row(policy)}
    conditions = {"recipes": table.recipes, "budget": 32_000} if table.trains else {}
    return {
        "table": name,
        "data_version": 1,
        "package_version": "0.1.0",
        **conditions,
        "rows": rows,
    }


class FakeTraining:
    """Stands in for lerobot-train: notes what it is told, and stops after some steps."""

    def __init__(self, steps):
        self.steps = steps
        self.told = []

    def __call__(self, module, arguments, log, name):
        self.told.append(list(arguments))
        options = dict(argument.lstrip("-").split("=", 1) for argument in arguments)
        checkpoint = Path(options["output_dir"]) / "checkpoints" / "last"
        (checkpoint / "pretrained_model").mkdir(parents=True, exist_ok=True)
        (checkpoint / "training_state").mkdir(exist_ok=True)
        step = json.dumps({"step": self.steps})
        (checkpoint / "training_state" / "training_step.json").write_text(step)
        if "steps" in options:
            config = json.dumps({"steps": int(options["steps"])})
            (checkpoint / "pretrained_model" / "train_config.json").write_text(config)
        with log.open("a") as file:
            file.write(LOGGED.format(self.steps))


@pytest.fixture
def lerobot_train(monkeypatch):
    def stopping_after(steps):
        fake = FakeTraining(steps)
        monkeypatch.setattr(training, "run_module", fake)
        return fake

    return stopping_after


def test_a_training_takes_the_recipe_and_as_many_steps_as_the_budget_holds(tmp_path, lerobot_train):
    fake = lerobot_train(10)
    train(Training("x", "dishwasher-train-p3-d80-v1", 64, ("--policy.a=b",)), 640, tmp_path)
    (told,) = fake.told
    assert told[0] == f"--config_path={recipe_file(RECIPE)}"
    assert {"--batch_size=64", "--steps=10", "--policy.a=b"} < set(told)
    assert "--dataset.repo_id=kitchen_prefs/dishwasher-train-p3-d80-v1" in told


def test_what_is_trained_is_not_trained_again(tmp_path, lerobot_train):
    fake = lerobot_train(20)
    for _ in range(2):
        train(BASE, 640, tmp_path)
    assert len(fake.told) == 1


def test_a_training_that_was_stopped_goes_on_from_its_checkpoint(tmp_path, lerobot_train):
    lerobot_train(5)
    checkpoint = train(BASE, 640, tmp_path)
    fake = lerobot_train(20)
    train(BASE, 640, tmp_path)
    assert fake.told[0][:2] == [f"--config_path={checkpoint}/train_config.json", "--resume=true"]


def test_a_training_that_was_stopped_before_its_first_checkpoint_begins_anew(
    tmp_path, lerobot_train
):
    lerobot_train(20)
    train(BASE, 640, tmp_path)
    shutil.rmtree(tmp_path / "train" / "checkpoints")
    (tmp_path / "train" / "left").touch()
    train(BASE, 640, tmp_path)
    assert not (tmp_path / "train" / "left").exists()


def test_a_run_that_begins_anew_has_a_log_of_its_own(tmp_path, lerobot_train):
    lerobot_train(20)
    train(BASE, 640, tmp_path)
    shutil.rmtree(tmp_path / "train")
    train(BASE, 640, tmp_path)
    assert (tmp_path / "train.log").read_text() == LOGGED.format(20)


def test_a_run_that_goes_on_goes_on_with_its_log(tmp_path, lerobot_train):
    lerobot_train(5)
    train(BASE, 640, tmp_path)
    lerobot_train(20)
    train(BASE, 640, tmp_path)
    assert (tmp_path / "train.log").read_text() == LOGGED.format(5) + LOGGED.format(20)


def test_a_run_that_somebody_else_began_is_left_alone(tmp_path, lerobot_train):
    fake = lerobot_train(20)
    (tmp_path / "train").mkdir()
    (tmp_path / "train" / "theirs").touch()
    with pytest.raises(ValueError, match="did not begin; let it finish or delete it"):
        train(BASE, 640, tmp_path)
    assert (tmp_path / "train" / "theirs").exists()
    assert not fake.told


def test_a_run_with_other_settings_is_refused(tmp_path, lerobot_train):
    lerobot_train(20)
    train(BASE, 640, tmp_path)
    with pytest.raises(ValueError, match="delete it or move it elsewhere"):
        train(Training("base", overrides=("--policy.rounds=1",)), 640, tmp_path)


def test_a_comment_in_the_recipe_is_no_other_setting(tmp_path, lerobot_train, monkeypatch):
    lerobot_train(20)
    train(BASE, 640, tmp_path)
    commented = tmp_path / "commented.yaml"
    commented.write_text(f"# A reason.\n\n{recipe_file(RECIPE).read_text()}")
    monkeypatch.setattr(training, "recipe_file", lambda name: commented)
    train(BASE, 640, tmp_path)


def test_what_was_trained_twice_counts_once_in_the_seconds(tmp_path):
    (tmp_path / "train.log").write_text("".join(LOGGED.format(n) for n in (1, 2, 3, 2, 3, 4)))
    assert seconds_of(BASE, 4 * 32, tmp_path) == 2


def test_a_command_that_fails_names_its_log(tmp_path):
    log = tmp_path / "told.log"
    with pytest.raises(OSError, match=r"told\.log says why"):
        run_module("kitchen_prefs.cli", ["reproduce", "nonsense"], log, "nonsense")
    assert "There is no table 'nonsense'" in log.read_text()


def test_a_table_that_does_not_exist_suggests_the_nearest():
    with pytest.raises(ValueError, match="Did you mean 'attributes'"):
        get_table("atributes")


def test_a_budget_below_one_batch_is_refused():
    with pytest.raises(ValueError, match="greater --budget"):
        BASE.steps(31)


def test_a_checkpoint_that_is_not_there_is_said_before_anything_runs(tmp_path, monkeypatch):
    missing = Table("", "", "", {"x": Committed("no_such")}, ("seen",), ("PE",))
    monkeypatch.setattr(table_runner, "run_module", pytest.fail)
    with pytest.raises(ValueError, match="There is no checkpoint 'no_such' yet"):
        table_runner.run_table("missing", missing, 32, 1, tmp_path)


def test_a_fine_tuning_goes_on_from_the_checkpoint_of_another_training(tmp_path, lerobot_train):
    fake = lerobot_train(20)
    start = train(BASE, 640, tmp_path / "base")
    tuning = FineTuning(BASE, 20)
    train(tuning.trainings[0], tuning.budget, tmp_path / "tuned", start)
    assert {
        f"--policy.path={start}",
        "--steps=20",
        "--optimizer.lr=1.0e-4",
        "--dataset.repo_id=kitchen_prefs/dishwasher-prompts-of8-d1-v1",
    } < set(fake.told[1])


def test_a_training_that_two_ask_for_at_once_is_run_once(tmp_path, lerobot_train):
    fake = lerobot_train(20)
    with ThreadPoolExecutor(4) as pool:
        list(pool.map(lambda _: train(BASE, 640, tmp_path), range(4)))
    assert len(fake.told) == 1


def test_every_training_has_its_data_set_and_its_settings():
    register_third_party_plugins()
    for policy in (*trainings(), *FineTuning(BASE, 1).trainings):
        content_of(policy.dataset)
        recipe = yaml.safe_load(recipe_file(policy.recipe).read_text())
        config = PreTrainedConfig.get_choice_class(recipe["policy"]["type"])
        for override in policy.overrides:
            if override.startswith("--policy."):
                setting = override.removeprefix("--policy.").partition("=")[0]
                assert setting in {field.name for field in fields(config)}


def test_trainings_of_one_name_are_one_training():
    assert len({policy.name for policy in trainings()}) == len(set(trainings()))


def test_the_recipe_is_what_the_base_rows_are_called():
    recipe = yaml.safe_load(recipe_file(RECIPE).read_text())
    policy = recipe["policy"]
    assert recipe["batch_size"] == BASE.batch_size == 32
    assert recipe["dataset"]["repo_id"] == f"kitchen_prefs/{BASE.dataset}"
    assert policy["time_encoding"] == "fourier"
    assert policy.get("extents_encoding", "fourier") == "fourier"
    assert policy.get("pose_encoding", "fourier") == "fourier"
    assert not policy.get("hidden")


@pytest.mark.parametrize("name", POLICY_TABLES)
def test_the_papers_values_stand_where_ours_do(name):
    table = TABLES[name]
    places = table.groups if len(table.groups) > 1 else tuple(table.rows)
    for values in table.paper_values.values():
        assert set(values) <= set(places)


def test_a_page_sets_our_figures_beside_the_papers(tmp_path):
    write_facts(made_up_facts("main"), tmp_path)
    write_facts(made_up_facts("attributes"), tmp_path)
    written = pages(tmp_path)
    assert "| TTP in the paper | 0.62 | 0.54 | 0.34 | - | - | - |" in written["main"]
    text = written["attributes"]
    assert "| pose, time | 0.40 [0.30, 0.50] | 0.40 [0.30, 0.50] | 0.419 |" in text
    assert "`kitchen-prefs reproduce attributes --budget=32000`" in text
    assert "training from scratch saw 32,000 decisions with the recipe `ttp_quick`" in text
    assert "the trainings took 900 to 900 s each" in text


def test_rows_in_which_all_figures_are_equal_become_a_sentence(tmp_path):
    facts = made_up_facts("main")
    seen = facts["rows"]["random"]["groups"]["seen"]
    seen["metrics"] = seen["metrics"] | {"PE": {"mean": 0.1, "low": 0, "high": 1}}
    write_facts(facts, tmp_path)
    section = pages(tmp_path)["main"].partition("### PE")[2].partition("###")[0]
    assert "| random | 0.10 [0.00, 1.00] | 0.40 [0.30, 0.50] |" in section
    assert "| symbolic |" not in section
    assert "; symbolic 0.80 [0.70, 0.90]; " in section


def test_rows_of_an_earlier_page_are_linked_and_not_repeated(tmp_path):
    write_facts(made_up_facts("main"), tmp_path)
    write_facts(made_up_facts("reinforcement"), tmp_path)
    text = pages(tmp_path)["reinforcement"]
    assert "on other pages: [random](main.md), [symbolic](main.md)." in text
    assert "symbolic 0.80" not in text


def test_the_overview_names_what_is_missing_and_takes_the_prose_as_it_is(tmp_path):
    (tmp_path / "prose").mkdir()
    (tmp_path / "prose" / "index.md").write_text("Our kitchen is another one.\n")
    (tmp_path / "prose" / "counts.md").write_text("Ten dishes are *many*.\n")
    write_facts(made_up_facts("counts"), tmp_path)
    written = pages(tmp_path)
    assert set(written) == {"index", "counts"}
    assert written["index"].startswith("# Results\n\nOur kitchen is another one.\n\n")
    assert "[The number of dishes](counts.md)" in written["index"]
    assert "\n\nTen dishes are *many*.\n\n" in written["counts"]
    missing = written["index"].partition("Not run yet")[2]
    assert {name for name in TABLES if f"`{name}`" in missing} == set(TABLES) - {"counts"}


def test_a_page_says_what_is_done_otherwise_than_in_the_paper(tmp_path):
    write_facts(made_up_facts("finetuning"), tmp_path)
    write_facts(made_up_facts("history"), tmp_path)
    written = pages(tmp_path)
    assert "all rows but 0 belong to the open track" in written["finetuning"]
    assert "the trainings took 3 to 900 s each" in written["finetuning"]
    assert "| PE, other prompt on unseen_preferences (70) |" in written["finetuning"]
    assert (
        "trained on all decisions of preference 1 and measured on the picks" in written["history"]
    )


def test_damaged_facts_are_named(tmp_path):
    (tmp_path / "main.json").write_text('{"table": ')
    with pytest.raises(ValueError, match=r"main\.json is damaged; `kitchen-prefs reproduce main`"):
        pages(tmp_path)


@pytest.mark.parametrize(("name", "ours"), [("main", 7), ("attributes", 1), ("finetuning", 2)])
def test_a_picture_shows_our_means_and_the_papers_values(tmp_path, name, ours):
    table = TABLES[name]
    draw(table, made_up_facts(name), tmp_path / "table.png")
    pixels = np.asarray(Image.open(tmp_path / "table.png").convert("RGB")).astype(int)
    for colour in (*COLOURS[:ours], *["#000000"] * bool(table.paper_values)):
        red_green_blue = [int(colour[i : i + 2], 16) for i in (1, 3, 5)]
        assert (np.abs(pixels - red_green_blue).sum(axis=-1) < 20).sum() > 200


def test_the_committed_pages_are_written_from_the_committed_facts():
    folder = ROOT / "docs" / "results"
    committed = {file.stem: file.read_text() for file in folder.glob("*.md")}
    assert committed == pages(folder)


def test_the_committed_facts_are_those_of_the_tables():
    for name, facts in read_facts(ROOT / "docs" / "results").items():
        assert list(facts["rows"]) == list(TABLES[name].rows)
        assert (ROOT / "docs" / "results" / f"{name}.png").exists()


@pytest.mark.lerobot
@pytest.mark.slow
def test_a_tiny_table_is_run_once_and_reported(tmp_path, monkeypatch):
    tiny = Training("tiny", "dishwasher-train-p2-d3-v1", 4, SMALL)
    table = Table(
        title="Tiny",
        paper="Nothing.",
        axis="dishes per rack",
        rows={"TTP": tiny, "symbolic": Rule("symbolic")},
        splits=("val",),
        metrics=("PE", "Category accuracy"),
        by_count=True,
    )
    monkeypatch.setitem(paper_tables.TABLES, "tiny", table)
    for name, value in (("HF_LEROBOT_HOME", tmp_path), ("HF_DATASETS_CACHE", tmp_path / "cache")):
        monkeypatch.setenv(name, str(value))
    options = ("--budget=8", f"--out={tmp_path / 'out'}", f"--results={tmp_path / 'results'}")
    done = run("reproduce", "tiny", *options)
    assert done.exit_code == 0, done.exception
    log = (tmp_path / "out" / "8" / "tiny" / "train.log").read_text()
    written = (tmp_path / "results" / "tiny.json").read_text()
    facts = json.loads(written)
    assert facts["rows"]["TTP"]["options"][1:3] == ["--batch_size=4", "--steps=2"]
    groups = facts["rows"]["symbolic"]["groups"]
    assert {name: group["episodes"] for name, group in groups.items()} == {
        "6": 35,
        "7": 35,
        "val": 70,
    }

    assert run("reproduce", "tiny", *options).exit_code == 0
    assert (tmp_path / "out" / "8" / "tiny" / "train.log").read_text() == log
    assert (tmp_path / "results" / "tiny.json").read_text() == written

    assert run("results", f"--results={tmp_path / 'results'}").exit_code == 0
    text = (tmp_path / "results" / "tiny.md").read_text()
    assert "symbolic 1.00 [1.00, 1.00]" in text
    assert "### Category accuracy\n\n|  | val (70) |" in text
