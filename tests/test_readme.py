"""The README: short, its Python runs, its commands name what exists, its table is up to date."""

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
import typer

from kitchen_prefs.cli import command_line
from kitchen_prefs.splits import SPLITS
from kitchen_prefs_experiments.paper.readme_table import replace_table
from kitchen_prefs_experiments.recipes import recipe_file

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text()


def blocks(language):
    return re.findall(rf"```{language}\n(.*?)```", README, re.DOTALL)


@pytest.mark.lerobot
@pytest.mark.slow
@pytest.mark.parametrize("block", blocks("python"), ids=lambda block: block.splitlines()[0])
def test_python_runs_as_printed(block, tmp_path):
    environment = os.environ | {"HF_HOME": str(tmp_path), "HF_HUB_OFFLINE": "1"}
    environment.pop("HF_LEROBOT_HOME", None)
    done = subprocess.run(
        [sys.executable, "-c", block],
        env=environment,
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout


def test_the_environment_needs_ten_lines_and_no_lerobot():
    block = next(block for block in blocks("python") if "gymnasium.make" in block)
    code = [line for line in block.splitlines()[2:] if line.strip()]
    assert len(code) <= 10
    assert "lerobot" not in block


def test_commands_name_recipes_and_splits_that_exist():
    commands = "\n".join(blocks("bash"))
    for name in re.findall(r"--recipe=(\S+)", commands):
        assert recipe_file(name).exists()
    for names in re.findall(r"--(?:split|env\.task)=(\S+)", commands):
        assert set(names.split(",")) <= set(SPLITS)


def test_commands_exist():
    commands = typer.main.get_command(command_line())
    for words in re.findall(r"kitchen-prefs ((?:[a-z][a-z-]* ?)+)", "\n".join(blocks("bash"))):
        command = commands
        for word in words.split():
            subcommands = getattr(command, "commands", None)
            if subcommands is None:
                break  # an argument, such as a run's folder
            assert word in subcommands, words
            command = subcommands[word]


def test_it_is_short():
    assert len(README.splitlines()) < 200


def test_the_table_is_written_from_the_leaderboards_scores():
    scores = json.loads((ROOT / "leaderboard" / "scores.json").read_text())
    assert replace_table(README, scores) == README, "`kitchen-prefs readme-table` writes it"


def test_links_lead_somewhere():
    for target in re.findall(r"\]\((?!http)([^)#]+)\)", README):
        assert (ROOT / target).exists(), target
