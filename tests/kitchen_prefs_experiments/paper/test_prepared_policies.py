"""Policies made ready: which options their trainings take, and what each is evaluated on."""

from kitchen_prefs.splits import HELD_OUT_USERS, SPLITS
from kitchen_prefs_experiments.paper.evaluated_policies import (
    BASE,
    RECIPE,
    Committed,
    FineTuning,
    Rule,
    Training,
)
from kitchen_prefs_experiments.paper.prepared_policies import prepare, train
from kitchen_prefs_experiments.recipes import recipe_file


def test_a_training_takes_the_recipe_and_as_many_steps_as_the_budget_holds(tmp_path, lerobot_train):
    fake = lerobot_train(10)
    train(Training("x", "dishwasher-train-p3-d80-v1", 64, ("--policy.a=b",)), 640, tmp_path)
    (arguments,) = fake.calls
    assert arguments[0] == f"--config_path={recipe_file(RECIPE)}"
    assert {"--batch_size=64", "--steps=10", "--policy.a=b"} < set(arguments)
    assert "--dataset.repo_id=kitchen_prefs/dishwasher-train-p3-d80-v1" in arguments


def test_a_finished_training_is_not_trained_again(tmp_path, lerobot_train):
    fake = lerobot_train(20)
    for _ in range(2):
        train(BASE, 640, tmp_path)
    assert len(fake.calls) == 1


def test_a_training_that_was_stopped_resumes_from_its_checkpoint(tmp_path, lerobot_train):
    lerobot_train(5)
    checkpoint = train(BASE, 640, tmp_path).checkpoint
    fake = lerobot_train(20)
    train(BASE, 640, tmp_path)
    assert fake.calls[0][:2] == [f"--config_path={checkpoint}/train_config.json", "--resume=true"]


def test_a_fine_tuning_starts_from_the_checkpoint_of_another_training(tmp_path, lerobot_train):
    fake = lerobot_train(20)
    start = train(BASE, 640, tmp_path / "base").checkpoint
    tuning = FineTuning(BASE, 20)
    train(tuning.trainings[0], tuning.budget, tmp_path / "tuned", start)
    assert {
        f"--policy.path={start}",
        "--steps=20",
        "--optimizer.lr=1.0e-4",
        "--dataset.repo_id=kitchen_prefs/dishwasher-prompts-of8-d1-v1",
    } < set(fake.calls[1])


def test_a_fine_tuning_becomes_a_policy_for_each_held_out_preference(tmp_path, lerobot_train):
    lerobot_train(10)
    policies = prepare(FineTuning(BASE, 10), 320, tmp_path)
    assert [one.preference for one in policies] == list(HELD_OUT_USERS)
    assert len({one.folder for one in policies}) == len(HELD_OUT_USERS)
    assert all("--steps=10" in one.description.options for one in policies)
    assert all(one.description.seconds == 5 for one in policies)  # half a second a step
    sessions = SPLITS["unseen_preferences"]
    assert set(sessions.users) == {one.preference for one in policies}


def test_a_checkpoint_and_a_rule_take_a_number_of_prompts(tmp_path):
    (checkpoint,) = prepare(Committed("ttp_plus", prompts=2), 32, tmp_path)
    assert checkpoint.options == [
        f"--policy.path={Committed('ttp_plus').find()}",
        "--prompts=2",
    ]
    assert checkpoint.folder == tmp_path / "checkpoints" / "ttp_plus-2-prompts"
    (rule,) = prepare(Rule("symbolic"), 32, tmp_path)
    assert rule.options == ["--policy.type=rules", "--policy.rule=symbolic", "--prompts=1"]
    assert rule.description.rule == "symbolic"
