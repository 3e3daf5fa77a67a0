"""TTP's parts: prompts, categories, relabelling, attention, schedule."""

import numpy as np
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st

from kitchen_prefs.envs.demonstrations import demonstrate, prompt_of
from kitchen_prefs.envs.observations import EXTENTS as DISH_EXTENTS
from kitchen_prefs.instances import CHOSEN, COLUMNS, DECISION, EXTENTS, IS_OBJECT, IS_PLACE, POSE
from kitchen_prefs.simulation.layout import COUNTER_HEIGHT
from kitchen_prefs.simulation.sessions import expert_trajectory
from lerobot_policy_kitchen_prefs.common.instance_sets import chosen_rows, is_real
from lerobot_policy_kitchen_prefs.ttp.attention import Attention, GeometricScores, Tokens
from lerobot_policy_kitchen_prefs.ttp.prompt_tokens import tokens_of_prompts
from lerobot_policy_kitchen_prefs.ttp.rack_poses import find_racks
from lerobot_policy_kitchen_prefs.ttp.relabelling import relabel
from lerobot_policy_kitchen_prefs.ttp.scheduler import ExponentialDecaySchedulerConfig

HEIGHT, ELEVATION = 2, 5  # columns
FIXTURES = 3  # the door and two racks
SEEDS = st.integers(0, 10_000)


def test_the_targets_are_the_rows_that_the_expert_chose(sessions):
    for session in sessions:
        demonstration = demonstrate(session)
        sets, actions = map(torch.from_numpy, (demonstration.instances, demonstration.action))
        assert chosen_rows(sets, actions).tolist() == demonstration.chosen_index.tolist()


def test_compact_prompts_are_the_chosen_rows_in_order(sessions):
    prompts = torch.from_numpy(np.stack([prompt_of(session) for session in sessions]))
    tokens, mask = tokens_of_prompts(prompts, "chosen")
    for prompt, rows, real in zip(prompts, tokens, mask, strict=True):
        assert torch.equal(rows[real], prompt[prompt[:, CHOSEN] > 0][:, :COLUMNS])
        assert (rows[real, DECISION] == torch.arange(int(real.sum()))).all()


def final_tokens(prompts):
    """The rows of each prompt's final tokens, as a set."""
    tokens, mask = tokens_of_prompts(prompts, "final")
    return [
        {tuple(row) for row in rows[real].tolist()} for rows, real in zip(tokens, mask, strict=True)
    ]


def test_final_prompts_are_where_all_dishes_stand_in_the_end(sessions):
    prompts = torch.from_numpy(np.stack([prompt_of(session) for session in sessions]))
    for session, rows in zip(sessions, final_tokens(prompts), strict=True):
        kitchen = expert_trajectory(session).kitchen
        racked = np.flatnonzero(kitchen.placement >= 0)
        extents = DISH_EXTENTS[kitchen.dishes.category[racked]]
        marks = np.tile(np.array([0, 1, 0]), (len(racked), 1))  # no time, an object, no place
        expected = np.hstack([extents, kitchen.pose[racked], marks]).astype(np.float32)
        assert rows == {tuple(row) for row in expected.tolist()}


def test_final_prompts_tell_neither_order_nor_time(sessions):
    prompts = torch.from_numpy(np.stack([prompt_of(session) for session in sessions]))
    before = final_tokens(prompts)
    shuffled = prompts[:, torch.randperm(prompts.shape[1])]
    shuffled[..., DECISION] *= 3
    shuffled[..., CHOSEN] = 0
    assert final_tokens(shuffled) == before


def test_relabelling_keeps_how_many_dishes_stand_in_each_rack(pairs, categories, stands):
    relabelled = relabel(pairs, categories, stands, np.random.default_rng(0))
    counts = []
    for prompts in (pairs.prompts, relabelled.prompts):
        tokens, mask = tokens_of_prompts(prompts, "final")
        rack, in_rack = find_racks(tokens)
        assert in_rack[mask].all()
        counts.append((mask & (rack == 0)).sum(dim=1).tolist())
    assert counts[0] == counts[1]


def test_the_paper_s_prompts_have_an_act_token_after_each_decision(sessions):
    prompts = torch.from_numpy(np.stack([prompt_of(session) for session in sessions]))
    tokens, mask = tokens_of_prompts(prompts, "states")
    for prompt, rows, real in zip(prompts, tokens, mask, strict=True):
        decisions = int(prompt[:, CHOSEN].sum())
        is_act = real & ~is_real(rows)
        assert int(is_act.sum()) == decisions
        assert is_act[int(real.sum()) - 1]
        assert not rows[is_act].any()
        before = is_act.cumsum(0)[real & ~is_act]
        assert torch.equal(before.float(), rows[real & ~is_act][:, DECISION])
        assert torch.equal(rows[real & ~is_act], prompt[is_real(prompt)][:, :COLUMNS])


def test_each_situation_goes_with_a_prompt_of_its_preference(pairs, demonstrations, sessions):
    of_prompt = [
        next(
            label
            for episode, label in enumerate(demonstrations.preference)
            if torch.equal(prompt, torch.from_numpy(demonstrations.prompts([episode])[0]))
        )
        for prompt in map(_trimmed, pairs.prompts)
    ]
    assert {of_prompt[g] for g in pairs.prompt_of.tolist()} == {sessions[0].label}
    is_place = (pairs.sets[..., IS_PLACE] > 0).any(dim=1)
    assert (pairs.prompt_of[is_place] == 0).all()
    assert pairs.prompt_of[~is_place].bincount().unique().numel() == 1


def _trimmed(prompt):
    return prompt[: int(is_real(prompt).sum())]


def test_all_dishes_and_places_have_a_category_and_nothing_else_has(pairs, categories):
    category, is_dish = categories.find(pairs.sets)  # (S, N)
    assert len(categories) == 7
    assert torch.equal(categories.extents[category[is_dish]], pairs.sets[is_dish][:, EXTENTS])
    assert ((is_real(pairs.sets) & ~is_dish).sum(dim=1) == FIXTURES).all()
    assert not (is_dish & ~is_real(pairs.sets)).any()


@settings(max_examples=10, deadline=None)
@given(seed=SEEDS)
def test_relabelling_permutes_extents_and_sets_dishes_on_the_counter(
    pairs, categories, stands, seed
):
    relabelled = relabel(pairs, categories, stands, np.random.default_rng(seed))
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
    pairs, demonstrations, categories, stands, seed
):
    relabelled = relabel(pairs, categories, stands, np.random.default_rng(seed))
    rows = demonstrations.rows
    known = rows[(rows[:, IS_PLACE] > 0) & (rows[:, CHOSEN] > 0)]
    shown = {(tuple(row[EXTENTS]), tuple(row[POSE])) for row in known.tolist()}
    of_rack = {(extents, _is_high(pose)) for extents, pose in shown}
    in_rack = _stands_in_rack(pairs.prompts, categories)
    moved = 0
    for old, new in zip(pairs.prompts[in_rack], relabelled.prompts[in_rack], strict=True):
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
    return categories.find(rows)[1] & find_racks(rows)[1]


def _stands_on_counter(rows):
    bottom = rows[..., ELEVATION] - rows[..., HEIGHT] / 2
    return ((bottom - COUNTER_HEIGHT).abs() < 1e-5) & (rows[..., IS_OBJECT] > 0)


def test_prompt_and_situation_are_relabelled_alike(pairs, categories, stands):
    relabelled = relabel(pairs, categories, stands, np.random.default_rng(0))
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


def test_geometric_scores_are_squared_distances():
    torch.manual_seed(0)
    heads, dim = 2, 8
    attention = Attention(
        dim, heads, GeometricScores([(900.0, 0.0, 3.0), (0.0, 50.0, 0.0)])
    ).double()
    with torch.no_grad():
        attention.query.weight.zero_()
        attention.query.bias.zero_()
    tokens, memory = (
        Tokens(
            torch.randn(1, n, dim).double(),
            torch.ones(1, n, dtype=torch.bool),
            torch.cat([0.2 * torch.rand(1, n, 6), torch.arange(n)[None, :, None] % 2], -1).double(),
        )
        for n in (3, 5)
    )
    difference = (tokens.geometry[:, :, None] - memory.geometry[:, None]).square()
    alike = 3 * memory.geometry[:, None, :, 6] - 900 * difference[..., :3].sum(-1)
    near = -50 * difference[..., 3:6].sum(-1)
    scores = torch.stack([alike, near], dim=1)  # (1, h, N, M)
    values = attention.key_value(memory.features)[..., dim:].unflatten(-1, (heads, -1))
    expected = torch.einsum("bhnm,bmhd->bnhd", scores.softmax(-1), values).flatten(2)
    assert torch.allclose(attention(tokens, memory), attention.output(expected))


def test_the_paper_s_schedule_decays_once_in_ten_updates():
    optimizer = torch.optim.SGD([torch.zeros(1, requires_grad=True)], lr=0.01)
    scheduler = ExponentialDecaySchedulerConfig().build(optimizer, 100)
    rates = []
    for _ in range(21):
        rates.append(optimizer.param_groups[0]["lr"])
        optimizer.step()
        scheduler.step()
    assert rates == pytest.approx([0.01] * 10 + [0.01 * 0.9995] * 10 + [0.01 * 0.9995**2])
