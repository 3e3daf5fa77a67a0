"""A data set is checked by its rows and actions; made here without a picture being drawn."""

import json

import numpy as np
import pyarrow.parquet as pq
import pytest

pytest.importorskip("gym_hil", reason="needs the extra `robot`")

from kitchen_prefs.datasets.columns import fingerprint
from kitchen_prefs_robot.demonstrations import verification
from kitchen_prefs_robot.demonstrations.recording import HumanDemonstration
from kitchen_prefs_robot.demonstrations.storage import write_demonstrations
from kitchen_prefs_robot.demonstrations.verification import verify_demonstrations
from kitchen_prefs_robot.task.demonstrations import demonstrate
from kitchen_prefs_robot.task.sessions import make_session

pytestmark = [pytest.mark.slow, pytest.mark.lerobot]

NAME = "drawers-human-v1"


@pytest.fixture(scope="module")
def root(tmp_path_factory):
    shown = demonstrate(make_session("test", 0))
    pictures = np.zeros((len(shown.chosen), 240, 320, 3), np.uint8)
    folder = tmp_path_factory.mktemp("demonstrations") / NAME
    one = HumanDemonstration(3, 0, {"front": pictures}, shown.sets, shown.chosen, ())
    write_demonstrations([one], folder)
    return folder


@pytest.fixture
def published(root, tmp_path, monkeypatch):
    """As if the data set of `root` were the published one."""
    found = fingerprint(*verification._read(root))
    (tmp_path / "fingerprints.json").write_text(json.dumps({NAME: found}))
    monkeypatch.setattr(verification, "FINGERPRINTS", tmp_path / "fingerprints.json")


def test_the_published_set_is_what_it_says(root, published):
    *_, last = verify_demonstrations(NAME, root)
    assert last.startswith("Its fingerprint is ")
    assert "none is published" not in last


def test_another_set_of_the_same_name_is_told(root, published):
    verification.FINGERPRINTS.write_text(json.dumps({NAME: "another"}))
    with pytest.raises(ValueError, match="differs from the published drawers-human-v1"):
        list(verify_demonstrations(NAME, root))


def test_an_action_that_was_not_chosen_is_told(root, published):
    (path,) = root.glob("data/*/*.parquet")
    before, table = path.read_bytes(), pq.read_table(path)
    chosen = table["chosen_index"].to_pylist()
    chosen[0] = 1 - chosen[0]
    column = table.schema.get_field_index("chosen_index")
    pq.write_table(table.set_column(column, table.schema.field(column), [chosen]), path)
    with pytest.raises(ValueError, match="is not the pose of its chosen row"):
        list(verify_demonstrations(NAME, root))
    path.write_bytes(before)
