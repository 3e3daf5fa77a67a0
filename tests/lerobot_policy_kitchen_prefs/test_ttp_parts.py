"""TTP's parts: prompts, relabelling, attention, schedule."""

import numpy as np
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st

from kitchen_prefs.demonstrations import demonstrate, prompt_of
from kitchen_prefs.instances import CHOSEN, COLUMNS, DECISION, EXTENTS, IS_OBJECT, IS_PLACE
from kitchen_prefs.scene.layout import COUNTER_HEIGHT
from kitchen_prefs.sessions import make_session
from lerobot_policy_kitchen_prefs.ttp.attention import Attention, GeometricScores, Tokens
from lerobot_policy_kitchen_prefs.ttp.demonstrations import Demonstrations
from lerobot_policy_kitchen_prefs.ttp.pairing import make_pairs
from lerobot_policy_kitchen_prefs.ttp.prompts import tokens_of_prompts
from lerobot_policy_kitchen_prefs.ttp.relabelling import Relabelling
from lerobot_policy_kitchen_prefs.ttp.scheduler import ExponentialDecaySchedulerConfig
from lerobot_policy_kitchen_prefs.ttp.sets import chosen_rows, is_real

HEIGHT, ELEVATION = 2, 5  # columns
SESSIONS = [make_session("val", index) for index in (0, 1, 10, 11)]


@pytest.fixture(scope="module")
def demonstrations():
    rows = [prompt_of(session) for session in SESSIONS]
    rows = [prompt[prompt[:, IS_OBJECT] + prompt[:, IS_PLACE] > 0] for prompt in rows]
    labels = np.array([session.label for session in SESSIONS])
    return Demonstrations(np.concatenate(rows), np.array([len(r) for r in rows]), labels)


@pytest.fixture(scope="module")
def pairs(demonstrations):
    """All decisions of the first two sessions, each pick with three prompts."""
    parts = [demonstrate(session) for session in SESSIONS[:2]]
    sets = torch.from_numpy(np.concatenate([part.instances for part in parts]))
    actions = torch.from_numpy(np.concatenate([part.action for part in parts]))
    episodes = np.repeat([0, 1], [len(part.action) for part in parts])
    generator = np.random.default_rng(0)
    return make_pairs(sets, chosen_rows(sets, actions), episodes, demonstrations, 3, generator)


def test_the_targets_are_the_rows_that_the_expert_chose():
    for session in SESSIONS:
        demonstration = demonstrate(session)
        sets, actions = map(torch.from_numpy, (demonstration.instances, demonstration.action))
        assert chosen_rows(sets, actions).tolist() == demonstration.chosen_index.tolist()


def test_compact_prompts_are_the_chosen_rows_in_order():
    prompts = torch.from_numpy(np.stack([prompt_of(session) for session in SESSIONS]))
    tokens, mask = tokens_of_prompts(prompts, "chosen")
    for prompt, rows, real in zip(prompts, tokens, mask, strict=True):
        assert torch.equal(rows[real], prompt[prompt[:, CHOSEN] > 0][:, :COLUMNS])
        assert (rows[real, DECISION] == torch.arange(int(real.sum()))).all()


def test_the_paper_s_prompts_have_an_act_token_after_each_decision():
    prompts = torch.from_numpy(np.stack([prompt_of(session) for session in SESSIONS]))
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


def test_each_situation_goes_with_a_prompt_of_its_preference(pairs, demonstrations):
    of_prompt = [
        next(
            label
            for episode, label in enumerate(demonstrations.preference)
            if torch.equal(prompt, torch.from_numpy(demonstrations.prompts([episode])[0]))
        )
        for prompt in map(_trimmed, pairs.prompts)
    ]
    assert {of_prompt[g] for g in pairs.prompt_of.tolist()} == {SESSIONS[0].label}
    is_place = (pairs.sets[..., IS_PLACE] > 0).any(dim=1)
    assert (pairs.prompt_of[is_place] == 0).all()
    assert pairs.prompt_of[~is_place].bincount().unique().numel() == 1


def _trimmed(prompt):
    return prompt[: int(is_real(prompt).sum())]


@settings(max_examples=10, deadline=None)
@given(seed=st.integers(0, 10_000))
def test_relabelling_permutes_extents_and_sets_dishes_on_the_counter(pairs, demonstrations, seed):
    relabelled = Relabelling(demonstrations)(pairs, np.random.default_rng(seed))
    for before, after in ((pairs.prompts, relabelled.prompts), (pairs.sets, relabelled.sets)):
        changed = {column for column in range(before.shape[-1]) if column in (0, 1, 2, ELEVATION)}
        kept = [column for column in range(before.shape[-1]) if column not in changed]
        assert torch.equal(before[..., kept], after[..., kept])
        for old, new in zip(before[..., EXTENTS], after[..., EXTENTS], strict=True):
            pairs_of_extents = torch.cat([old, new], dim=-1).unique(dim=0)
            assert len(pairs_of_extents) == len(old.unique(dim=0)) == len(new.unique(dim=0))
        assert torch.equal(_stands_on_counter(before), _stands_on_counter(after))
    is_place = (pairs.sets[..., IS_PLACE] > 0).any(dim=1)
    assert torch.equal(relabelled.sets[is_place], pairs.sets[is_place])


def _stands_on_counter(rows):
    bottom = rows[..., ELEVATION] - rows[..., HEIGHT] / 2
    return ((bottom - COUNTER_HEIGHT).abs() < 1e-5) & (rows[..., IS_OBJECT] > 0)


def test_prompt_and_situation_are_relabelled_alike(pairs, demonstrations):
    relabelled = Relabelling(demonstrations)(pairs, np.random.default_rng(0))
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
