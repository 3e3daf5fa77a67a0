"""TTP in the browser chooses what TTP in Python chooses."""

import base64
import json
from itertools import chain
from pathlib import Path

import numpy as np
import pytest
import torch
from chromium import bare_page, needs_chromium
from safetensors.torch import save

from kitchen_prefs.envs.environment import DishwasherLoading
from kitchen_prefs.envs.observations import Observer
from kitchen_prefs.evaluation.policy_loading import load_policy
from kitchen_prefs.simulation.kitchen import Kitchen
from kitchen_prefs.simulation.sessions import expert_trajectory, make_session, prompt_sessions
from kitchen_prefs.web.kitchen_data import layout_data
from kitchen_prefs.web.page import SHARED, joined
from kitchen_prefs_demonstrations.page.observation_data import observed_kitchen, observed_session
from kitchen_prefs_demonstrations.page.policy_data import TEMPLATES, policy_data, policy_script

CHECKPOINT = Path(__file__).parents[3] / "policies/checkpoints/ttp_plus"
SESSIONS = {
    # Sessions of six or eight dishes, as each decision takes chromium thirty milliseconds.
    "unseen_counts": (0, 1, 6, 7, 12, 13, 18, 19, 24, 25, 30, 31, 36, 37, 42, 43),
    "unseen_preferences": (0, 1),
    "many_preferences": (0, 1),
}
# Of probabilities: the page's weights have half precision, Python's have float32.
TOLERANCE = 0.02
# Observes, decides and carries out whole episodes; as texts, lists cross over much faster.
EPISODES = """(asked) => {
    const ttp = new TTP(data.policy);
    return JSON.stringify(JSON.parse(asked).map(({ prompts, session, limit }) => {
        const memory = ttp.begin(ttp.readPrompts(prompts));
        const state = kitchenAtStart(session);
        const steps = [];
        while (!isFinished(state) && steps.length < limit) {
            const observation = observe(state, session, steps.length);
            const { instance, scores, attention } = ttp.decide(memory, observation);
            const ofRows = observation.ids.map((id, row) => [id, scores[row]]);
            const refused = decide(state, instance) !== "";
            const candidates = ofRows.filter(([, score]) => score > -Infinity);
            steps.push({ instance, refused, scores: Object.fromEntries(candidates),
                attention: attention.map((weights) => [...weights]) });
        }
        return steps;
    }));
}"""

pytestmark = [
    pytest.mark.xdist_group("ttp_in_javascript"),
    pytest.mark.browser,
    pytest.mark.slow,
    needs_chromium,
]


def played_in_python(sessions, prompts):
    """The episodes of a batch: what was chosen, refused and thought of each candidate."""
    policy = load_policy(str(CHECKPOINT))
    weigh, thoughts = policy.policy._log_probabilities, []

    def weigh_and_remember(*inputs):
        thoughts.append(weigh(*inputs))
        return thoughts[-1]

    policy.policy._log_probabilities = weigh_and_remember
    policy.reset()
    environments = [DishwasherLoading(split, prompts=prompts) for split, _ in sessions]
    observations = [
        environment.reset(options={"session": index})[0]
        for environment, (_, index) in zip(environments, sessions, strict=True)
    ]
    episodes = [[] for _ in environments]
    while any(not (e.simulator.terminated or e.simulator.truncated) for e in environments):
        actions = policy.act(observations, [e.task_description for e in environments])
        for i, environment in enumerate(environments):
            if environment.simulator.terminated or environment.simulator.truncated:
                continue
            ids = environment.simulator.observation.ids
            scores = thoughts[-1][i, : len(ids)].numpy()
            observations[i], _, _, _, info = environment.step(actions[i])
            episodes[i].append(
                {
                    "instance": environment.simulator.decisions[-1],
                    "refused": info["refusal"] != "",
                    "scores": {
                        str(id): score
                        for id, score in zip(ids.tolist(), scores.tolist(), strict=True)
                        if np.isfinite(score)
                    },
                }
            )
    return episodes, [environment.simulator.limit for environment in environments]


def demonstration_data(session):
    """A demonstration as the script takes it."""
    return {
        "session": observed_session(session),
        "decisions": expert_trajectory(session).decisions,
    }


def played_in_the_browser(page, sessions, limits, prompts):
    """The same episodes, by the script."""
    asked = []
    for (split, index), limit in zip(sessions, limits, strict=True):
        session = make_session(split, index)
        sources = prompt_sessions(session, "same", prompts)
        asked.append(
            {
                "prompts": [demonstration_data(source) for source in sources],
                "session": observed_session(session),
                "limit": limit,
            }
        )
    return json.loads(page.evaluate(EPISODES, json.dumps(asked)))


@pytest.fixture(scope="module")
def page(tmp_path_factory):
    """A page with the kitchen, what is observed of it and the policy."""
    data = {
        "layout": layout_data(),
        "observed": observed_kitchen(),
        "policy": policy_data(CHECKPOINT),
    }
    script = joined(SHARED / "basics.js", SHARED / "kitchen.js") + policy_script()
    with bare_page(tmp_path_factory.mktemp("ttp") / "ttp.html", script, data) as page:
        yield page


@pytest.fixture(scope="module")
def episodes(page):
    """Twenty episodes by Python and by the browser."""
    sessions = [(split, index) for split, indices in SESSIONS.items() for index in indices]
    in_python, limits = played_in_python(sessions, prompts=1)
    return in_python, played_in_the_browser(page, sessions, limits, prompts=1)


def choices(episodes):
    return [[step["instance"] for step in episode] for episode in episodes]


def test_every_decision_is_the_same(episodes):
    in_python, in_the_browser = episodes
    assert choices(in_the_browser) == choices(in_python)
    assert len(in_python) == 20
    assert sum(len(episode) for episode in in_python) >= 300


def test_the_same_decisions_are_refused(episodes):
    refused = [[[step["refused"] for step in episode] for episode in played] for played in episodes]
    assert refused[0] == refused[1]
    assert sum(map(sum, refused[0])) >= 10


def test_every_candidate_has_the_same_probability(episodes):
    in_python, in_the_browser = episodes
    for one, other in zip(chain(*in_python), chain(*in_the_browser), strict=True):
        assert one["scores"].keys() == other["scores"].keys()
        for instance, score in one["scores"].items():
            assert np.exp(other["scores"][instance]) == pytest.approx(np.exp(score), abs=TOLERANCE)


def test_attention_is_shared_among_the_decisions_of_the_demonstration(episodes):
    session = make_session("unseen_counts", 0)
    (source,) = prompt_sessions(session, "same", 1)
    for step in episodes[1][0]:
        (weights,) = step["attention"]
        assert len(weights) == len(expert_trajectory(source).decisions)
        assert sum(weights) == pytest.approx(1, abs=1e-5)


def test_several_demonstrations_are_read_as_in_python(page):
    sessions = [("unseen_counts", 0)]
    in_python, limits = played_in_python(sessions, prompts=2)
    in_the_browser = played_in_the_browser(page, sessions, limits, prompts=2)
    assert choices(in_the_browser) == choices(in_python)
    assert len(in_the_browser[0][0]["attention"]) == 2


def test_rows_are_those_of_the_environment_bit_by_bit(page):
    session = make_session("unseen_counts", 1)
    decisions = expert_trajectory(session).decisions
    kitchen = Kitchen(session.dishes)
    observer = Observer(kitchen, np.random.default_rng(0), None)
    wanted = []
    for instance in decisions:
        observation = observer.observe()
        ids = map(str, observation.ids.tolist())
        wanted.append(dict(zip(ids, observation.rows.tolist(), strict=True)))
        kitchen.decide(instance)
    observed = page.evaluate(
        """([session, decisions]) => {
            const state = kitchenAtStart(session);
            return JSON.stringify(decisions.map((instance, decision) => {
                const { rows, ids } = observe(state, session, decision);
                decide(state, instance);
                return Object.fromEntries(ids.map((id, i) => [id, [...rows[i]]]));
            }));
        }""",
        [observed_session(session), decisions],
    )
    assert json.loads(observed) == wanted


@pytest.mark.parametrize("dtype", [torch.float32, torch.float16, torch.bfloat16])
def test_weights_of_every_precision_are_read(page, dtype):
    numbers = torch.tensor([[0, -1.5, 3.14159], [6e-8, 65504, -1e-3]], dtype=dtype)
    weights = base64.b64encode(save({"numbers": numbers})).decode()
    shape, values = page.evaluate(
        f"""(weights) => {{
            {joined(TEMPLATES / "safetensors.js")}
            const {{ shape, values }} = readSafetensors(bytesOf(weights)).numbers;
            return [shape, [...values]];
        }}""",
        weights,
    )
    assert shape == [2, 3]
    assert values == numbers.float().flatten().tolist()


def test_a_demonstration_with_a_refused_decision_is_refused(page):
    demonstration = demonstration_data(make_session("seen", 0))
    demonstration["decisions"] = [2]
    told = page.evaluate(
        """(demonstration) => {
            try { new TTP(data.policy).readPrompts([demonstration]); } catch (error) {
                return error.message;
            }
        }""",
        demonstration,
    )
    assert told == "Decision 0 of a demonstration: A rack moves only with the door open."
