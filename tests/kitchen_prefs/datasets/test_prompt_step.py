"""Prompts in training: those of the environment, of other episodes, the same again when resumed."""

import json

import numpy as np
import pytest
import torch
from lerobot.configs import FeatureType, PipelineFeatureType, PolicyFeature
from lerobot.datasets import LeRobotDataset
from lerobot.policies import make_policy
from lerobot.policies.act.configuration_act import ACTConfig
from lerobot.processor import PolicyProcessorPipeline, ProcessorStepRegistry
from lerobot.processor.converters import batch_to_transition, transition_to_batch

from kitchen_prefs.datasets import make_dataset
from kitchen_prefs.datasets.demonstration_store import DemonstrationStore
from kitchen_prefs.datasets.prompt_step import PromptStep
from kitchen_prefs.envs.demonstrations import prompt_of
from kitchen_prefs.instances import POSE
from kitchen_prefs.simulation.sessions import make_session
from kitchen_prefs.splits import SPLITS

pytestmark = pytest.mark.xdist_group("prompt_step")  # one data set serves all

NAME = "dishwasher-train-p2-d3-v1"  # two preferences, three demonstrations each
EPISODES = 6


@pytest.fixture(scope="module")
def dataset(tmp_path_factory):
    return made(NAME, tmp_path_factory.mktemp("home"))


def made(name, home):
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("HF_LEROBOT_HOME", str(home))
        root = make_dataset(name)
    return LeRobotDataset(f"kitchen_prefs/{name}", root=root)


def step_of(dataset, **settings):
    return PromptStep(dataset.repo_id, str(dataset.root), **settings)


def pipeline_of(*steps):
    return PolicyProcessorPipeline(
        steps=list(steps), to_transition=batch_to_transition, to_output=transition_to_batch
    )


def batch_of(dataset, frames):
    return torch.utils.data.default_collate([dataset[i] for i in frames])


@pytest.fixture(scope="module")
def batch(dataset):
    return batch_of(dataset, range(0, dataset.num_frames, 4))


def environment_prompts(dataset):
    """The prompts that the environment makes of the data set's sessions."""
    train = SPLITS["train"]
    sessions = [i for user in (0, 1) for i in np.flatnonzero(np.array(train.users) == user)[:3]]
    return [torch.tensor(prompt_of(make_session("train", int(i)))) for i in sessions]


def drawn_episodes(dataset, prompts):
    """The episode of each prompt, which has to equal the environment's bit by bit."""
    known = environment_prompts(dataset)
    return [[torch.equal(prompt, other) for other in known].index(True) for prompt in prompts]


def test_prompts_are_the_environments_and_of_other_episodes_of_the_preference(dataset, batch):
    prompts = pipeline_of(step_of(dataset))(batch)["observation.prompt"]
    assert prompts.shape == (len(batch["index"]), 1664, 14)
    assert prompts.dtype == torch.float32
    drawn = drawn_episodes(dataset, prompts)
    for episode, other in zip(batch["episode_index"].tolist(), drawn, strict=True):
        assert other != episode
        assert other // 3 == episode // 3
    assert len(set(drawn)) == EPISODES


def test_nothing_else_in_the_batch_changes(dataset, batch):
    before, after = pipeline_of()(batch), pipeline_of(step_of(dataset))(batch)
    assert set(after) - set(before) == {"observation.prompt"}
    for key in ("observation.instances", "action", "episode_index", "index"):
        assert torch.equal(before[key], after[key])


def test_the_environments_prompt_passes_unchanged(dataset):
    prompt = torch.rand(2, 1664, 14)
    observation = {"observation.prompt": prompt, "observation.instances": torch.rand(2, 72, 13)}
    for step in (step_of(dataset), PromptStep()):
        assert pipeline_of(step)(observation)["observation.prompt"] is prompt


def test_prompts_depend_on_seed_and_batch_alone(dataset, batch):
    step = pipeline_of(step_of(dataset))
    first = step(batch)["observation.prompt"]
    step(batch_of(dataset, (3, 5)))  # other batches in between change nothing
    assert torch.equal(step(batch)["observation.prompt"], first)
    assert torch.equal(pipeline_of(step_of(dataset))(batch)["observation.prompt"], first)
    other = pipeline_of(step_of(dataset, seed=1))(batch)["observation.prompt"]
    assert not torch.equal(other, first)


def test_a_frame_meets_other_prompts_in_other_batches(dataset):
    step = pipeline_of(step_of(dataset))
    drawn = [step(batch_of(dataset, (0, i)))["observation.prompt"][0] for i in range(1, 12)]
    assert set(drawn_episodes(dataset, drawn)) == {1, 2}


def test_a_saved_step_draws_the_same(dataset, batch, tmp_path):
    pipeline = pipeline_of(step_of(dataset, seed=3))
    pipeline.save_pretrained(tmp_path)
    (file,) = tmp_path.glob("*.json")
    (saved,) = json.loads(file.read_text())["steps"]
    assert saved["registry_name"] == "kitchen_prefs_prompt"
    loaded = PolicyProcessorPipeline.from_pretrained(
        tmp_path, file.name, to_transition=batch_to_transition, to_output=transition_to_batch
    )
    assert torch.equal(loaded(batch)["observation.prompt"], pipeline(batch)["observation.prompt"])


def test_action_chunks_are_paired_too(dataset, batch):
    chunks = batch["action"][:, None].repeat(1, 5, 1)
    prompts = pipeline_of(step_of(dataset))({**batch, "action": chunks})["observation.prompt"]
    assert torch.equal(prompts, pipeline_of(step_of(dataset))(batch)["observation.prompt"])


@pytest.mark.parametrize(
    "change",
    [
        {"action": lambda batch: batch["action"] + 0.01},
        {"index": lambda batch: batch["index"] + 1},
        {"index": lambda batch: batch["index"] + 100_000},
    ],
)
def test_a_batch_of_another_data_set_is_refused(dataset, batch, change):
    changed = batch | {key: make(batch) for key, make in change.items()}
    with pytest.raises(ValueError, match=r"not of the data set .*policy_preprocessor\.json"):
        pipeline_of(step_of(dataset))(changed)


def test_a_batch_of_no_data_set_is_refused(dataset, batch):
    with pytest.raises(ValueError, match=r"no 'observation\.prompt'"):
        pipeline_of(PromptStep())(batch)
    with pytest.raises(ValueError, match=r"no 'observation\.prompt'"):
        pipeline_of(step_of(dataset))({"observation.instances": torch.zeros(1, 72, 13)})


def test_an_only_demonstration_is_refused(tmp_path):
    dataset = made("dishwasher-train-p2-d1-v1", tmp_path)
    with pytest.raises(ValueError, match=r"Episode 0 .* is the only one of its preference"):
        pipeline_of(step_of(dataset))(batch_of(dataset, (0, 1)))


def test_in_the_second_tier_the_users_other_session_prompts(tmp_path):
    dataset = made("dishwasher-people_train-u2-v2", tmp_path)
    batch = batch_of(dataset, range(0, dataset.num_frames, 20))
    prompts = pipeline_of(step_of(dataset))(batch)["observation.prompt"]
    assert prompts.shape == (len(batch["index"]), 2048, 22)
    for episode, prompt in zip(batch["episode_index"].tolist(), prompts, strict=True):
        mine = np.flatnonzero(np.array(dataset.hf_dataset["episode_index"]) == episode ^ 1)
        actions = torch.stack([dataset[int(i)]["action"] for i in mine])
        assert torch.equal(prompt[prompt[:, -1] > 0][:, POSE], actions)
    sets = PolicyFeature(FeatureType.STATE, (1596,))
    features = {PipelineFeatureType.OBSERVATION: {"observation.instances": sets}}
    stated = PromptStep().transform_features(features)[PipelineFeatureType.OBSERVATION]
    assert stated["observation.prompt"].shape == (2048, 22)


@pytest.mark.parametrize("chosen_only", [True, False])
def test_demonstrations_read_in_pieces_are_the_same(dataset, monkeypatch, chosen_only):
    whole = DemonstrationStore.read(dataset.meta, chosen_only)
    monkeypatch.setattr("kitchen_prefs.datasets.demonstration_store.AT_ONCE", 7)
    pieces = DemonstrationStore.read(dataset.meta, chosen_only)
    for name in ("rows", "preference", "places"):
        assert np.array_equal(getattr(whole, name), getattr(pieces, name))
    everything = range(len(whole.preference))
    assert np.array_equal(whole.prompts(everything), pieces.prompts(everything))


def test_it_is_registered_and_states_its_feature():
    assert ProcessorStepRegistry.get("kitchen_prefs_prompt") is PromptStep
    features = PromptStep().transform_features({PipelineFeatureType.OBSERVATION: {}})
    assert features[PipelineFeatureType.OBSERVATION]["observation.prompt"].shape == (1664, 14)


def test_it_learns_from_the_policy_where_the_data_set_lies(dataset):
    config = ACTConfig(
        device="cpu", dim_model=32, dim_feedforward=32, chunk_size=1, n_action_steps=1
    )
    assert PromptStep.from_config(config) == PromptStep()
    make_policy(config, ds_meta=dataset.meta)
    assert PromptStep.from_config(config, seed=2) == step_of(dataset, seed=2)
