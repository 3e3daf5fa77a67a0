"""Policies that are loaded: their fingerprints, and what is refused."""

import pytest
from act_checkpoints import rewrite, save_act

from kitchen_prefs.evaluation.policy_loading import load_policy


def test_a_checkpoint_is_known_by_its_weights(tmp_path):
    one = load_policy(str(save_act(tmp_path / "one")))
    again = load_policy(str(save_act(tmp_path / "again")))
    other = load_policy(str(save_act(tmp_path / "other", seed=1)))
    assert one.fingerprint == again.fingerprint != other.fingerprint


def test_a_setting_that_changes_what_it_does_changes_the_fingerprint(tmp_path):
    path = str(save_act(tmp_path))
    assert load_policy(path, options=["--n_action_steps=1"]).fingerprint != (
        load_policy(path).fingerprint
    )
    assert load_policy(path, options=["--push_to_hub=false"]).fingerprint == (
        load_policy(path).fingerprint
    )


def test_a_processor_that_changes_what_it_does_changes_the_fingerprint(tmp_path):
    before = load_policy(str(save_act(tmp_path))).fingerprint
    rewrite(
        tmp_path / "policy_postprocessor.json",
        lambda processor: processor["steps"][0]["config"].update(eps=5.0),
    )
    assert load_policy(str(tmp_path)).fingerprint != before


def test_a_checkpoint_that_does_not_fit_is_refused(tmp_path):
    with pytest.raises(ValueError, match=r"'observation\.state' of shape \(9,\)"):
        load_policy(str(save_act(tmp_path, state_size=9)))


def test_unknown_policies_and_settings_are_refused_with_the_nearest(tmp_path):
    with pytest.raises(ValueError, match="Did you mean 'rules'"):
        load_policy(policy_type="rule")
    with pytest.raises(ValueError, match="Did you mean 'rule'"):
        load_policy(policy_type="rules", options=["--rul=expert"])
    with pytest.raises(ValueError, match="Did you mean 'expert'"):
        load_policy(policy_type="rules", options=["--rule=exprt"])
    with pytest.raises(ValueError, match="no setting 'dim_modl'"):
        load_policy(str(save_act(tmp_path)), options=["--dim_modl=3"])


def test_a_folder_without_a_policy_is_refused(tmp_path):
    with pytest.raises(ValueError, match="There is no policy in"):
        load_policy(str(tmp_path))
    with pytest.raises(ValueError, match="There is no policy in"):
        load_policy(str(tmp_path / "nowhere"))
    with pytest.raises(ValueError, match="Give either"):
        load_policy()


@pytest.mark.parametrize("policy_type", ["act", "ttp"])
def test_a_policy_that_has_to_be_trained_is_not_scored_untrained(policy_type):
    with pytest.raises(ValueError, match=f"'{policy_type}' has to be trained first: give --policy"):
        load_policy(policy_type=policy_type)
