"""The learning curves: when each checkpoint came, and what page and figure show of it."""

import json
import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
import yaml
from PIL import Image

from kitchen_prefs.evaluation.checkpoint_selection import Selection
from kitchen_prefs.metrics import METRICS, Interval
from kitchen_prefs_experiments import lerobot_train
from kitchen_prefs_experiments.paper import learning_curves
from kitchen_prefs_experiments.paper.figures import COLOURS, draw
from kitchen_prefs_experiments.paper.learning_curves import run_curves
from kitchen_prefs_experiments.paper.paper_tables import TABLES
from kitchen_prefs_experiments.paper.result_files import write_results
from kitchen_prefs_experiments.paper.results_page import pages
from kitchen_prefs_experiments.recipes import recipe_file

CURVES = TABLES["learning"]
LOGGED = "INFO ot_train.py:641 step:{} loss:2.1 updt_s:0.400 data_s:0.100 smp/s:310\n"


@dataclass
class Machine:
    """Stands in for lerobot-train and for the selection of a checkpoint."""

    calls: list

    def train(self, module, arguments, log, title):
        self.calls.append(list(arguments))
        run = Path(arguments[-1].removeprefix("--output_dir="))
        save(run, 400)
        with log.open("a") as file:
            file.writelines(LOGGED.format(step) for step in (200, 400))

    def select(self, run):
        folders = sorted(run.glob("checkpoints/0*/pretrained_model"))
        head_start = 0.2 * (run.name == "ttp_quick")
        steps = {one.parent.name: int(one.parent.name) / 1000 + head_start for one in folders}
        metrics = {
            step: dict.fromkeys(METRICS, Interval(value, value - 0.1, value + 0.1))
            for step, value in steps.items()
        }
        return Selection(folders[-1], metrics)


def config_of(recipe):
    """What lerobot-train keeps of a recipe of 400 steps, and what it adds."""
    settings = yaml.safe_load(recipe_file(recipe).read_text())
    settings["policy"].pop("path", None)
    return settings | {"steps": 400, "seed": 1000}


def save(run, step, **changed):
    """Checkpoints as lerobot-train leaves them: every 200 steps, and a link to the last."""
    config = json.dumps(config_of(run.name) | changed)
    for at in range(200, step + 1, 200):
        checkpoint = run / "checkpoints" / f"{at:06}"
        (checkpoint / "pretrained_model").mkdir(parents=True, exist_ok=True)
        (checkpoint / "training_state").mkdir(exist_ok=True)
        state = json.dumps({"step": at})
        (checkpoint / "training_state" / "training_step.json").write_text(state)
        (checkpoint / "pretrained_model" / "train_config.json").write_text(config)
    last = run / "checkpoints" / "last"
    last.unlink(missing_ok=True)
    last.symlink_to(f"{step:06}")


@pytest.fixture
def machine(tmp_path, monkeypatch):
    """A folder to work in, where the recipes take 400 steps."""

    def shortened(recipe):
        text = recipe_file(recipe).read_text()
        file = tmp_path / f"{recipe}.yaml"
        file.write_text(re.sub(r"^steps: \d+", "steps: 400", text, flags=re.MULTILINE))
        return file

    machine = Machine([])
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(lerobot_train, "run_module", machine.train)
    for module in (lerobot_train, learning_curves):
        monkeypatch.setattr(module, "recipe_file", shortened)
    monkeypatch.setattr(learning_curves, "make_dataset", lambda name: None)
    monkeypatch.setattr(learning_curves, "select_checkpoint", machine.select)
    return machine


def test_each_recipe_is_trained_where_the_next_one_looks_for_it(machine, tmp_path):
    run_curves("learning", CURVES)
    assert machine.calls == [
        [
            f"--config_path={tmp_path}/{recipe}.yaml",
            "--log_freq=1",
            f"--output_dir=outputs/{recipe}",
        ]
        for recipe in ("ttp_quick", "ttp_plus", "ttp_paper")
    ]
    assert "path: outputs/ttp_quick/checkpoints/last" in recipe_file("ttp_plus").read_text()


def test_a_checkpoint_comes_after_the_seconds_of_its_steps_and_of_the_run_it_continues(machine):
    rows = run_curves("learning", CURVES).rows
    seconds = {recipe: [p.seconds for p in row.points] for recipe, row in rows.items()}
    assert seconds == {"ttp_quick": [100, 200], "ttp_plus": [300, 400], "ttp_paper": [100, 200]}
    assert rows["ttp_plus"].steps == rows["ttp_plus"].best == 400
    assert set(rows["ttp_plus"].points[0].metrics) == {"Score", "PE", "ED_c"}


def test_a_finished_run_is_not_trained_again_and_a_stopped_one_resumes(machine):
    run_curves("learning", CURVES)
    save(Path("outputs/ttp_paper"), 200)
    machine.calls.clear()
    rows = run_curves("learning", CURVES).rows
    last = Path("outputs/ttp_paper/checkpoints/last/pretrained_model/train_config.json")
    assert machine.calls == [
        [f"--config_path={last}", "--resume=true", "--output_dir=outputs/ttp_paper"]
    ]
    # Twice 400 steps stand in the log, but only 400 led to the last checkpoint.
    assert rows["ttp_paper"].seconds == 200


def test_a_finished_run_of_the_recipe_may_be_of_any_program(machine):
    save(Path("outputs/ttp_quick"), 400)
    Path("outputs/ttp_quick.log").write_text(LOGGED.format(400))
    assert run_curves("learning", CURVES).rows["ttp_quick"].seconds == 200
    assert len(machine.calls) == 2


@pytest.mark.parametrize("step", [0, 200])
def test_a_run_of_another_program_is_left_alone(machine, step):
    theirs = Path("outputs/ttp_paper")
    theirs.mkdir(parents=True)
    if step:
        save(theirs, step)
    with pytest.raises(ValueError, match=r"ttp_paper is a run .* let it finish or delete it"):
        run_curves("learning", CURVES)
    assert theirs.exists()
    assert not machine.calls


@pytest.mark.parametrize(
    ("changed", "differing"),
    [
        ({"steps": 200}, "steps"),
        ({"batch_size": 8, "optimizer": None}, "optimizer.type and .* and batch_size"),
        ({"policy": config_of("ttp_plus")["policy"] | {"recognise": False}}, "policy.recognise"),
    ],
)
def test_a_finished_run_with_other_settings_is_not_the_recipes(machine, changed, differing):
    save(Path("outputs/ttp_plus"), changed.get("steps", 400), **changed)
    Path("outputs/ttp_plus.log").write_text(LOGGED.format(400))
    with pytest.raises(ValueError, match=f"the recipe 'ttp_plus' differ in {differing}; delete"):
        run_curves("learning", CURVES)
    assert not machine.calls


def test_what_is_not_decisive_may_differ(machine):
    save(Path("outputs/ttp_plus"), 400, num_workers=0, log_freq=7)
    Path("outputs/ttp_plus.log").write_text(LOGGED.format(400))
    run_curves("learning", CURVES)


@pytest.mark.parametrize("recipe", ["ttp_quick", "ttp_paper"])
def test_lerobot_keeps_the_settings_of_a_recipe_as_they_stand(recipe):
    import draccus
    from lerobot.configs.train import TrainPipelineConfig

    import lerobot_policy_kitchen_prefs  # noqa: F401, registers the policies

    config = draccus.parse(TrainPipelineConfig, recipe_file(recipe), args=[])
    settings = yaml.safe_load(recipe_file(recipe).read_text())
    assert not list(learning_curves._differing(settings, draccus.encode(config)))


def test_a_finished_run_without_its_log_is_named_before_anything_is_trained(machine):
    save(Path("outputs/ttp_plus"), 400)
    with pytest.raises(ValueError, match=r"outputs/ttp_plus\.log holds no durations of steps"):
        run_curves("learning", CURVES)
    assert not machine.calls


def test_the_page_has_the_minutes_and_the_best_step(machine, tmp_path):
    write_results(run_curves("learning", CURVES), tmp_path)
    text = pages(tmp_path)["learning"]
    assert "| recipe | steps | minutes | best step | PE at the best step |" in text
    assert "| `ttp_plus` | 400 | 7 | 400 | 0.40 [0.30, 0.50] | 0.40 [0.30, 0.50] |" in text
    assert "`kitchen-prefs reproduce learning` made the figures; data version" in text


def test_the_picture_has_a_line_for_each_recipe(machine, tmp_path):
    draw(CURVES, run_curves("learning", CURVES), tmp_path / "learning.png")
    pixels = np.asarray(Image.open(tmp_path / "learning.png").convert("RGB")).astype(int)
    for colour in COLOURS[:3]:
        red_green_blue = [int(colour[i : i + 2], 16) for i in (1, 3, 5)]
        assert (np.abs(pixels - red_green_blue).sum(axis=-1) < 20).sum() > 200
