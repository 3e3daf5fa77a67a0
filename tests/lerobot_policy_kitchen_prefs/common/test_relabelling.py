"""Relabelling: prompt and situation are permuted alike, and poses follow the new category."""

import numpy as np
import torch
from hypothesis import given, settings
from hypothesis import strategies as st

from kitchen_prefs.instances import CHOSEN, EXTENTS, IS_OBJECT, IS_PLACE, POSE
from kitchen_prefs.simulation.layout import COUNTER_HEIGHT
from lerobot_policy_kitchen_prefs.common.dish_locations import in_rack, in_top_rack
from lerobot_policy_kitchen_prefs.common.relabelling import relabel
from lerobot_policy_kitchen_prefs.ttp.prompt_tokens import tokens_of_prompts

HEIGHT, ELEVATION = 2, 5  # columns
SEEDS = st.integers(0, 10_000)


def relabelled_pairs(pairs, categories, rack_poses, generator):
    prompts, sets = relabel(
        pairs.prompts, pairs.sets, pairs.prompt_of, categories, rack_poses, generator
    )
    return pairs._replace(prompts=prompts, sets=sets)


def test_relabelling_keeps_how_many_dishes_stand_in_each_rack(pairs, categories, rack_poses):
    relabelled = relabelled_pairs(pairs, categories, rack_poses, np.random.default_rng(0))
    counts = []
    for prompts in (pairs.prompts, relabelled.prompts):
        tokens, mask = tokens_of_prompts(prompts, "final")
        assert in_rack(tokens)[mask].all()
        counts.append((mask & ~in_top_rack(tokens)).sum(dim=1).tolist())
    assert counts[0] == counts[1]


@settings(max_examples=10, deadline=None)
@given(seed=SEEDS)
def test_relabelling_permutes_extents_and_sets_dishes_on_the_counter(
    pairs, categories, rack_poses, seed
):
    relabelled = relabelled_pairs(pairs, categories, rack_poses, np.random.default_rng(seed))
    for before, after in ((pairs.prompts, relabelled.prompts), (pairs.sets, relabelled.sets)):
        kept = [c for c in range(before.shape[-1]) if c not in (0, 1, 2, ELEVATION)]
        elsewhere = ~_stands_in_rack(before, categories)
        assert torch.equal(before[elsewhere][:, kept], after[elsewhere][:, kept])
        for old, new in zip(before[..., EXTENTS], after[..., EXTENTS], strict=True):
            pairs_of_extents = torch.cat([old, new], dim=-1).unique(dim=0)
            assert len(pairs_of_extents) == len(old.unique(dim=0)) == len(new.unique(dim=0))
        assert torch.equal(_stands_on_counter(before), _stands_on_counter(after))
    is_place = (pairs.sets[..., IS_PLACE] > 0).any(dim=1)
    assert torch.equal(relabelled.sets[is_place], pairs.sets[is_place])


@settings(max_examples=10, deadline=None)
@given(seed=SEEDS)
def test_relabelled_dishes_stand_in_the_same_rack_as_such_dishes_do(
    pairs, demonstrations, categories, rack_poses, seed
):
    relabelled = relabelled_pairs(pairs, categories, rack_poses, np.random.default_rng(seed))
    rows = demonstrations.rows
    known = rows[(rows[:, IS_PLACE] > 0) & (rows[:, CHOSEN] > 0)]
    shown = {(tuple(row[EXTENTS]), tuple(row[POSE])) for row in known.tolist()}
    of_rack = {(extents, _is_high(pose)) for extents, pose in shown}
    racked = _stands_in_rack(pairs.prompts, categories)
    moved = 0
    for old, new in zip(pairs.prompts[racked], relabelled.prompts[racked], strict=True):
        extents, pose = tuple(new[EXTENTS].tolist()), tuple(new[POSE].tolist())
        assert _is_high(pose) == _is_high(old[POSE])
        if (extents, _is_high(pose)) in of_rack:
            assert (extents, pose) in shown
            moved += not torch.equal(old[POSE], new[POSE])
        else:
            assert torch.equal(old[POSE], new[POSE])
    assert moved


def _is_high(pose):
    """Whether a pose in a rack is in the top one, half a metre above the floor."""
    return bool(pose[2] > 0.5)


def _stands_in_rack(rows, categories):
    return categories.find(rows)[1] & in_rack(rows)


def _stands_on_counter(rows):
    bottom = rows[..., ELEVATION] - rows[..., HEIGHT] / 2
    return ((bottom - COUNTER_HEIGHT).abs() < 1e-5) & (rows[..., IS_OBJECT] > 0)


def test_prompt_and_situation_are_relabelled_alike(pairs, categories, rack_poses):
    relabelled = relabelled_pairs(pairs, categories, rack_poses, np.random.default_rng(0))
    seen = [{} for _ in pairs.prompts]
    is_pick = ~(pairs.sets[..., IS_PLACE] > 0).any(dim=1)
    for g, sets, new in (
        *zip(range(len(seen)), pairs.prompts, relabelled.prompts, strict=True),
        *zip(
            pairs.prompt_of[is_pick].tolist(),
            pairs.sets[is_pick],
            relabelled.sets[is_pick],
            strict=True,
        ),
    ):
        for old_row, new_row in zip(sets.tolist(), new.tolist(), strict=True):
            category = tuple(new_row[EXTENTS])
            assert seen[g].setdefault(tuple(old_row[EXTENTS]), category) == category
    assert len({tuple(sorted(mapping.items())) for mapping in seen}) == len(seen)
