"""The committed entries are of the policies of this repository, as they are now."""

import json
from pathlib import Path

import pytest
from lerobot.utils.import_utils import is_package_available

from kitchen_prefs.evaluation.policy_loading import load_policy

ROOT = Path(__file__).parents[2]
ENTRIES = sorted(
    file.parent for file in (ROOT / "leaderboard/submissions").glob("*/submission.json")
)


@pytest.mark.parametrize("folder", ENTRIES, ids=lambda folder: folder.name)
def test_an_entry_names_the_fingerprint_of_its_policy(folder):
    about = json.loads((folder / "submission.json").read_text())
    if about["policy"]["type"] == "diffusion" and not is_package_available("diffusers"):
        pytest.skip("needs the extra diffusion")
    track = None if about["track"] == "open" else about["track"]
    checkpoint = ROOT / "policies/checkpoints" / folder.name
    if checkpoint.is_dir():
        policy = load_policy(str(checkpoint), track=track)
    else:
        policy = load_policy(policy_type="rules", options=[f"--rule={folder.name}"], track=track)
    assert policy.fingerprint == about["policy"]["checkpoint"]
