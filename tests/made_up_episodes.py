"""Episodes for tests of metrics: two cups belong into the top rack, a tray into the bottom one."""

from hypothesis import strategies as st

from kitchen_prefs.metrics import Episode

KIND = {0: "door", 1: "bottom rack", 2: "top rack", 3: "cup", 4: "cup", 5: "tray", 999: "in sink"}
KIND |= {1000 + k: "in bottom" for k in range(3)} | {2000 + k: "in top" for k in range(3)}

CUPS = (2, 3, 2000, 4, 2001, 2)
TRAY = (1, 5, 1000, 1)
EXPERT = (0, *CUPS, *TRAY, 0)


def episode_of(decisions=EXPERT, **facts) -> Episode:
    """An episode in which the expert decides EXPERT and the policy the given decisions."""
    perfect = {
        "split": "seen",
        "session": 0,
        "salt": 0,
        "preference": 0,
        "count": 2,
        "decisions": decisions,
        "kinds": tuple(KIND[d] for d in decisions),
        "expert_decisions": EXPERT,
        "expert_kinds": tuple(KIND[d] for d in EXPERT),
        "placed": (2, 1),
        "expert_placed": (2, 1),
        "wrong_rack": 0,
        "sunk": 0,
        "expert_sunk": 0,
        "refused": (False,) * len(decisions),
        "blocked_places": 0,
        "longest_loop": 0,
        "turns": (2, 2),
        "closed_early": 0,
        "closed": True,
        "finished": True,
        "actions": ((0.0,) * 7,) * len(decisions),
    }
    return Episode(**(perfect | facts))


episodes = st.builds(
    lambda decisions, right, wrong, **facts: episode_of(
        tuple(instance for instance, _ in decisions),
        refused=tuple(refused for _, refused in decisions),
        turns=(right, right + wrong),
        **facts,
    ),
    st.lists(st.tuples(st.sampled_from(sorted(KIND)), st.booleans()), max_size=2 * len(EXPERT)),
    right=st.integers(1, 9),
    wrong=st.integers(0, 9),
    placed=st.tuples(st.integers(0, 5), st.integers(0, 5)),
    expert_placed=st.tuples(st.integers(0, 5), st.integers(0, 5)),
    preference=st.integers(0, 3),
    closed=st.booleans(),
    finished=st.booleans(),
)
