"""Prompt tokens: which rows of a demonstration the prompt encoder reads."""

import numpy as np
import torch

from kitchen_prefs.envs.demonstrations import prompt_of
from kitchen_prefs.envs.observations import EXTENTS as DISH_EXTENTS
from kitchen_prefs.instances import CHOSEN, COLUMNS, DECISION, is_real
from kitchen_prefs.simulation.sessions import expert_trajectory
from lerobot_policy_kitchen_prefs.ttp.prompt_tokens import tokens_of_prompts


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
