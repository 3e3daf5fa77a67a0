"""A submission from plain Python: a policy that chooses among the choosable rows at random.

python leaderboard/examples/by_hand.py outputs/by_hand
"""

import bz2
import json
import sys
from pathlib import Path

import gymnasium

import kitchen_prefs

SPLITS = ["seen", "unseen_preferences", "unseen_counts", "unseen_both", "many_preferences", "noisy"]
folder = Path(sys.argv[1])
folder.mkdir(parents=True)
about = {
    "format": 1,
    "name": "By hand",
    "authors": ["A. Author"],
    "track": "standard",
    "policy": {"type": "by_hand"},
    "data_version": 1,
    "fingerprints": {},
    "packages": {"kitchen_prefs": "0.1.0"},
    "hardware": "none",
    "training": "none",
}
(folder / "submission.json").write_text(json.dumps(about))
for split in SPLITS:
    env = gymnasium.make("kitchen_prefs/DishwasherLoading-v0", split=split).unwrapped
    with bz2.open(folder / f"{split}.jsonl.bz2", "wt") as file:
        for session in range(env.split.sessions):
            observation, _ = env.reset(seed=session, options={"session": session})
            line = {"session": session, "first": env.digest(), "actions": []}
            done = False
            while not done:
                rows = kitchen_prefs.instances.unpad(observation["instances"])
                choosable = rows[kitchen_prefs.instances.choosable(rows)]  # (c, 13)
                pose = env.np_random.choice(choosable)[3:10].astype(float).round(4).tolist()
                observation, _, terminated, truncated, _ = env.step(pose)
                line["actions"].append(pose)
                done = terminated or truncated
            file.write(json.dumps(line | {"last": env.digest()}) + "\n")
