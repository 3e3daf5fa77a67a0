"""What a re-run must show to confirm a submission, and the records of re-runs."""

import json
from dataclasses import replace

import pytest

from kitchen_prefs.metrics import score
from kitchen_prefs_leaderboard.judgement import Reruns, compare
from kitchen_prefs_leaderboard.ranking import rank
from kitchen_prefs_leaderboard.scoring import score_submissions
from kitchen_prefs_leaderboard.submission_format import Policy
from kitchen_prefs_leaderboard.submission_writing import write_submission
from kitchen_prefs_leaderboard.verification import (
    check_policy,
    read_verifications,
    write_verification,
)

SALT = 7
ALL = range(6)  # all sessions of a split that was cut short


@pytest.fixture
def found(few_episodes):
    """What a re-run of an entry comes to, in which some sessions go badly."""

    def compared(entry, rerun=(), fresh=(), alone=None, again=None, singly=None):
        on_fresh = few_episodes(fresh, SALT)
        reruns = Reruns(few_episodes(rerun), on_fresh, alone or on_fresh, again, singly)
        return compare(entry, reruns, salt=SALT, by="A. Maintainer", sandbox=True)

    return compared


def test_the_same_policy_confirms(make_entry, found):
    entry = make_entry("a")
    verification = found(entry)
    assert verification.confirmed
    assert verification.digest == entry.digest
    assert verification.salt == SALT
    assert verification.same == 1
    assert verification.replayed == verification.rerun == verification.fresh


def test_a_few_sessions_that_went_otherwise_do_not_matter(make_entry, found):
    assert found(make_entry("a"), rerun=[0], fresh=[0]).confirmed
    assert found(make_entry("a", worse=[0]), fresh=[1]).confirmed


def test_another_policy_does_not_play(make_entry):
    submission = make_entry("a").submission
    check_policy(submission, submission.policy)
    for other in ({"checkpoint": "f" * 64}, {"parameters": 12}, {"type": "another"}):
        with pytest.raises(ValueError, match=r"is of another policy \(expert, .* than this one"):
            check_policy(submission, submission.policy.model_copy(update=other))


def test_a_submission_without_a_checkpoint_cannot_be_confirmed(make_entry):
    entry = make_entry("a", policy=Policy(type="by_hand"))
    with pytest.raises(ValueError, match="names no checkpoint"):
        check_policy(entry.submission, entry.submission.policy)


def test_actions_better_than_the_policy_are_not_confirmed(make_entry, found):
    verification = found(make_entry("a"), rerun=ALL, fresh=())
    assert not verification.confirmed
    assert verification.rerun.mean < verification.replayed.mean


def test_actions_worse_than_the_policy_are_not_confirmed(make_entry, found):
    assert not found(make_entry("a", worse=ALL)).confirmed


def test_episodes_that_were_thrown_away_do_not_make_room(make_entry, found, few_episodes):
    thrown_away = make_entry("a", worse=range(4))  # its own interval is wide
    verification = found(thrown_away, again=few_episodes(), singly=few_episodes())
    assert verification.same < 0.95 < verification.itself
    assert not verification.repeats


@pytest.mark.parametrize(("worse", "confirmed"), [((2,), True), (ALL, False)])
def test_a_stochastic_policy_is_judged_by_its_own_spread(
    make_entry, found, few_episodes, worse, confirmed
):
    again, singly = few_episodes([2, 3]), few_episodes([4, 5])
    verification = found(make_entry("a", worse=worse), [0, 1], again=again, singly=singly)
    assert verification.itself < 0.95
    assert verification.repeats == confirmed
    assert verification.runs == 3
    assert verification.independent
    alone = [score(episode) for episode in singly["seen"]]  # the run that no batch helped
    assert verification.scores["seen"] == pytest.approx(alone, abs=1e-4)


def test_a_stochastic_policy_that_its_batch_helps_is_not_confirmed(make_entry, found, few_episodes):
    again, singly = few_episodes([2]), few_episodes(ALL)
    verification = found(make_entry("a", worse=[1]), [0], again=again, singly=singly)
    assert verification.itself < 0.95
    assert not verification.independent
    assert not verification.confirmed


def test_a_policy_whose_episodes_depend_on_each_other_is_not_confirmed(
    make_entry, found, few_episodes
):
    verification = found(make_entry("a"), alone=few_episodes(ALL, SALT))
    assert verification.repeats
    assert not verification.independent
    assert not verification.confirmed


@pytest.mark.parametrize(("spoilt", "confirmed"), [(0, True), (1, True), (6, False)])
def test_a_policy_that_knows_the_held_out_users_alone_is_not_confirmed(
    make_entry, few_episodes, spoilt, confirmed
):
    entry, fresh = make_entry("a"), few_episodes(salt=SALT)
    for split in ("unseen_preferences", "unseen_both"):
        fresh[split] = [
            replace(e, preference=100 + e.preference, placed=(0, 0) if i < spoilt else e.placed)
            for i, e in enumerate(fresh[split])
        ]
    rerun = few_episodes()
    about = {"salt": SALT, "by": "A. Maintainer", "sandbox": True}
    assert compare(entry, Reruns(rerun, fresh, rerun), **about).generalises == confirmed


def test_records_of_the_earlier_procedure_are_still_read(make_entry, found, tmp_path):
    new = ("procedure", "by", "sandbox", "runs", "itself", "alone", "scores", "independent")
    old = found(make_entry("a")).model_dump(exclude=set(new))
    (tmp_path / "old.json").write_text(json.dumps(old))
    (verification,) = read_verifications(tmp_path).values()
    assert verification.procedure == 1


def test_a_policy_that_knows_the_published_sessions_alone_is_not_confirmed(make_entry, found):
    verification = found(make_entry("a"), fresh=ALL)
    assert not verification.confirmed
    assert verification.fresh.mean < verification.rerun.mean == verification.replayed.mean


def test_records_are_read_as_they_were_written(make_entry, found, tmp_path):
    verification = found(make_entry("a"), rerun=[0])
    file = write_verification(verification, tmp_path / "records")
    assert file.name == f"{verification.digest}.json"
    assert read_verifications(tmp_path / "records") == {verification.digest: verification}


def test_a_later_rerun_that_does_not_confirm_takes_the_rank_away(make_entry, found, tmp_path):
    entry = make_entry("a")
    write_verification(found(entry), tmp_path)
    assert rank([entry], read_verifications(tmp_path))["privileged"][0].rank == 1
    write_verification(found(entry, fresh=ALL), tmp_path)
    assert rank([entry], read_verifications(tmp_path))["privileged"][0].rank is None


@pytest.mark.parametrize("content", ["", "[]", "{}", '{"confirmed": true}'])
def test_what_is_no_record_is_said_in_one_sentence(content, tmp_path):
    (tmp_path / "x.json").write_text(content)
    with pytest.raises(ValueError, match=r"x.json is no record of a re-run; delete it .*again\.$"):
        read_verifications(tmp_path)


@pytest.mark.usefixtures("few_sessions")
def test_a_changed_byte_of_a_submission_takes_its_rank_away(
    make_entry, few_episodes, found, tmp_path
):
    folder, records = tmp_path / "submission", tmp_path / "records"
    write_submission(make_entry("a").submission, few_episodes(), folder)

    def rank_now():
        entries = score_submissions([folder], 1)
        return rank(entries, read_verifications(records))["privileged"][0].rank

    write_verification(found(score_submissions([folder], 1)[0]), records)
    assert rank_now() == 1
    with (folder / "submission.json").open("a") as file:
        file.write("\n")  # says nothing else
    assert rank_now() is None
