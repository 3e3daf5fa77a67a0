import pytest
from typer.testing import CliRunner

from kitchen_prefs.physics import placement_search
from kitchen_prefs.physics.commands import app


@pytest.fixture
def saved(monkeypatch):
    """What the command would have written to the data folder."""
    records = []
    monkeypatch.setattr(
        placement_search, "save_placements", lambda _, record, scale: records.append(record)
    )
    return records


@pytest.mark.slow
def test_check_carries_the_experts_loads_and_records_the_share(saved):
    result = CliRunner().invoke(app, ["check-placements", "--sessions", "1"])
    assert result.exit_code == 0, result.output
    check = saved[0]["truth_check"]
    assert check["sessions"] == 1
    assert f"{check['stayed']:.1%} of {check['dishes']} dishes stayed" in result.output


@pytest.mark.parametrize("command", ["make-placements", "check-placements"])
def test_help_has_an_example(command):
    result = CliRunner().invoke(app, [command, "--help"])
    assert f"kitchen-prefs physics {command}" in result.output
