"""Speed, relative to yardsticks measured in the same run: `uv run python -m benchmarks`.

A machine's speed drifts and machines differ, so the ratio is what to compare.
"""

import json
from pathlib import Path

import typer

from benchmarks.data import loader_samples, making_episodes
from benchmarks.kitchen import kitchen_decisions
from benchmarks.people import people_beside_preferences
from benchmarks.prompts import prompt_steps
from benchmarks.training import training_steps


def main(out: Path = Path("outputs/benchmarks.json")) -> None:
    """Run all benchmarks; takes about four minutes on two cores.

    For example:
    uv run python -m benchmarks
    """
    results = []
    measures = (
        kitchen_decisions,
        making_episodes,
        people_beside_preferences,
        loader_samples,
        training_steps,
        prompt_steps,
    )
    for measure in measures:
        for result in measure():
            results.append(result)
            typer.echo(result)
    out.parent.mkdir(parents=True, exist_ok=True)
    out.write_text(json.dumps([vars(result) for result in results], indent=2) + "\n")
    typer.echo(f"\nThe figures are in {out}.")


if __name__ == "__main__":  # worker processes import this file too
    typer.run(main)
