"""What verification asks of episodes: each is what the user of its session does."""

from collections.abc import Sequence
from dataclasses import astuple

import numpy as np
from tqdm import tqdm

from kitchen_prefs.datasets.certificates import certificate_of
from kitchen_prefs.datasets.stored_data import Data
from kitchen_prefs.envs.environment import DishwasherLoading
from kitchen_prefs.envs.kitchen_env import KitchenEnv
from kitchen_prefs.envs.people_environment import DishwasherPeople
from kitchen_prefs.metrics import edit_similarity, packing_efficiency
from kitchen_prefs.metrics.people_episode import refused_decisions, turn, where
from kitchen_prefs.people.sessions import make_people_session
from kitchen_prefs.people.splits import get_people_split
from kitchen_prefs.people.words import user_in_words
from kitchen_prefs.simulation.sessions import make_session
from kitchen_prefs.splits import get_split

SAMPLED = 20  # episodes spread over the data set; a wrong kitchen or expert shows in any of them
CERTIFICATE_TOLERANCE = 2e-6  # the last digit is rounded


def check_preferences(data: Data) -> None:
    """Check that each episode has the preference of its session, in label and words."""
    for episode, (split, index) in enumerate(data.content.sessions):
        session = make_session(split, index)
        _check_label(data, episode, session.label, session.preference.in_words, "preference")


def check_users(data: Data) -> None:
    """Check that each episode has the user of its session, in number and words."""
    sessions = tqdm(data.content.sessions, "users", unit="episode", leave=False)
    for episode, (split, index) in enumerate(sessions):
        user = make_people_session(split, index).user
        number = get_people_split(split).user(index)
        _check_label(data, episode, number, user_in_words(user), "user")


def check_certificates(data: Data) -> None:
    """Compute the certificates of a sample of the episodes again."""
    if len(data.certificates) != len(data.lengths):
        raise ValueError(f"{len(data.certificates)} certificates, not {len(data.lengths)}.")
    sample = _sample(range(len(data.lengths)))
    for episode in tqdm(sample, "certificates", unit="episode", leave=False):
        session = make_people_session(*data.content.sessions[episode])
        stored, found = astuple(data.certificates[episode]), astuple(certificate_of(session))
        if not np.allclose(stored, found, rtol=0, atol=CERTIFICATE_TOLERANCE):
            raise ValueError(f"the certificate of episode {episode} is not what its prompts say.")


def replay_preferences(data: Data) -> None:
    """Replay a sample of the episodes in kitchens without noise; PE and ED must be 1."""
    sessions = data.content.sessions
    quiet = [i for i, (split, _) in enumerate(sessions) if not get_split(split).noisy]
    for episode in tqdm(_sample(quiet), "replay", unit="episode", leave=False):
        environment = DishwasherLoading(sessions[episode][0])
        _replay(data, episode, environment)
        facts = environment.episode()
        perfect = packing_efficiency(facts) == 1 and edit_similarity(facts) == 1
        _check_perfect(episode, perfect and facts.finished)


def replay_users(data: Data) -> None:
    """Replay a sample of the episodes; Where and Turn must be 1, and nothing refused."""
    sessions = data.content.sessions
    for episode in tqdm(_sample(range(len(sessions))), "replay", unit="episode", leave=False):
        environment = DishwasherPeople(sessions[episode][0])
        _replay(data, episode, environment)
        facts = environment.episode()
        perfect = where(facts) == 1 and turn(facts) in (1, None) and not refused_decisions(facts)
        _check_perfect(episode, perfect and facts.finished)


def _check_label(data: Data, episode: int, label: int, words: str, of: str) -> None:
    frames = data.frames(episode)
    if (data.columns["preference"][frames] != label).any():
        raise ValueError(f"episode {episode} does not have the {of} of its session.")
    if {data.tasks[i] for i in data.columns["task_index"][frames]} != {words}:
        raise ValueError(f"the task of episode {episode} is not its {of} in words.")


def _replay(data: Data, episode: int, environment: KitchenEnv) -> None:
    """Give the stored actions of an episode to the environment."""
    frames = data.frames(episode)
    environment.reset(options={"session": data.content.sessions[episode][1]})
    rewards = [environment.step(action)[1] for action in data.columns["action"][frames]]
    if not np.array_equal(rewards, data.columns["next.reward"][frames]):
        raise ValueError(f"the rewards of episode {episode} are not those of its decisions.")


def _check_perfect(episode: int, perfect: bool) -> None:
    if not perfect:
        raise ValueError(f"episode {episode} does not load the dishwasher as the expert does.")


def _sample(episodes: Sequence[int]) -> Sequence[int]:
    return episodes[:: max(len(episodes) // SAMPLED, 1)]
