"""A submission with which nothing is wrong for its reader; only the kitchen would refuse it."""

ABOUT = {
    "format": 1,
    "name": "Honest",
    "authors": ["A. Author"],
    "link": "https://example.org/",
    "track": "standard",
    "policy": {"type": "by_hand", "parameters": 12, "checkpoint": "0" * 64},
    "data_version": 1,
    "fingerprints": {},
    "packages": {"kitchen_prefs": "0.1.0"},
    "hardware": "none",
    "training": "none",
}
POSE = [0.5, -0.25, 1.0, 1.0, 0.0, 0.0, 0.0]
EPISODE = {"session": 0, "first": "0" * 64, "actions": [POSE, POSE], "last": "0" * 64}
