"""Writes demonstrations as a data set in the project's format, which every LeRobot tool reads.

The label of an episode is that of the preference which the demonstration follows, so that prompts
are paired with it in training and an expert exists in evaluation. An episode that follows none has
a negative label, one for each user, so that it is paired with this user's demonstrations alone; its
rewards are 0.

`meta/demonstrations.json` has one entry for each episode: who gave it, with consent or not, where
it starts, whether it is finished and how much of it the preference explains.
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from kitchen_prefs.datasets.names import NAMESPACE, dataset_root, is_in_grammar
from kitchen_prefs.envs.demonstrations import Demonstration, record
from kitchen_prefs.utils.files import at_work_alone, atomic_folder, make_folder, write_json
from kitchen_prefs_demonstrations.implied_preference import ImpliedPreference, implied_preference
from kitchen_prefs_demonstrations.replaying import ReplayedDemonstration, read_and_replay

MADE_OF = Path("meta") / "demonstrations.json"
CARD = Path(__file__).with_name("card.md")
NAME = re.compile(r"[a-z0-9][a-z0-9_.-]{0,95}")  # as the Hugging Face hub has it, in small letters
TASK_OF_ITS_OWN = "Load the dishwasher as this user does."


@dataclass(frozen=True)
class ImportedEpisode:
    """One episode of a data set of demonstrations.

    Attributes:
        replayed: The demonstration.
        implied: The preference that was read from it.
        label: The preference's label; negative if the demonstration does not follow it.
    """

    replayed: ReplayedDemonstration
    implied: ImpliedPreference
    label: int

    @property
    def frames(self) -> Demonstration:
        """Its frames."""
        session = replace(self.replayed.session, preference=self.implied.preference)
        frames = record(session, self.replayed.decisions)
        if self.label >= 0:
            return frames
        none = np.zeros_like(frames.reward)
        return replace(frames, preference=self.label, task=TASK_OF_ITS_OWN, reward=none)


def import_demonstrations(
    files: Sequence[Path], name: str, without_consent: bool = False
) -> list[ImportedEpisode]:
    """Write files of demonstrations as the data set `kitchen_prefs/NAME`, one episode a file.

    Args:
        files: The files, which are untrusted.
        name: The data set's name.
        without_consent: Whether to take demonstrations whose users did not agree.

    Returns:
        The episodes, in the order of the files.

    Raises:
        ValueError: If the name is taken or is none, if a file is no demonstration, or if its user
            did not agree to a data set.
        OSError: If the data set cannot be written; nothing is left of it.
    """
    root = _free_root(name)
    replayed = [read_and_replay(file) for file in files]
    if not without_consent:
        _check_consent(files, replayed)
    make_folder(root.parent, "HF_LEROBOT_HOME")
    episodes = _labelled(replayed)
    with at_work_alone(root), atomic_folder(root) as unfinished:
        _write(root.name, episodes, unfinished)
    return episodes


def _free_root(name: str) -> Path:
    name = name.removeprefix(f"{NAMESPACE}/")
    if not NAME.fullmatch(name):
        raise ValueError(
            f"A data set's name has small letters, digits, '-', '_' and '.', unlike {name!r}."
        )
    if is_in_grammar(name):
        raise ValueError(f"{name} is the name of a published data set; give another --name.")
    root = dataset_root(name)
    if root.exists():
        raise ValueError(f"{root} holds something already; give another --name, or delete it.")
    return root


def _check_consent(files: Sequence[Path], replayed: Sequence[ReplayedDemonstration]) -> None:
    missing = [str(f) for f, r in zip(files, replayed, strict=True) if not r.file.consent]
    if missing:
        others = f" and {len(missing) - 1} more" if len(missing) > 1 else ""
        raise ValueError(
            f"{missing[0]}{others} came without consent to be kept in a data set; leave out what "
            "did, or add --without-consent if it is your own or the data set stays with you."
        )


def _labelled(replayed: Sequence[ReplayedDemonstration]) -> list[ImportedEpisode]:
    """Give each demonstration its label; each user, and each unknown one, has a negative label."""
    users: dict[str, int] = {}
    episodes = []
    for number, demonstration in enumerate(replayed):
        own = users.setdefault(demonstration.file.who or f"unknown {number}", -1 - len(users))
        implied = implied_preference(demonstration)
        session = replace(demonstration.session, preference=implied.preference)
        label = session.label if implied.is_followed else own
        episodes.append(ImportedEpisode(demonstration, implied, label))
    return episodes


def _write(name: str, episodes: Sequence[ImportedEpisode], root: Path) -> None:
    from kitchen_prefs.datasets.manifest import write_manifest
    from kitchen_prefs.datasets.writing import frames_of, write_episodes  # import LeRobot: seconds

    frames = (frames_of(episode.frames) for episode in episodes)
    write_episodes(name, frames, len(episodes), root)
    write_json(root / MADE_OF, {"episodes": [_facts(episode) for episode in episodes]})
    write_manifest(name, root)
    agreed = sum(episode.replayed.file.consent for episode in episodes)
    facts = {"name": name, "episodes": len(episodes), "agreed": agreed}
    (root / "README.md").write_text(CARD.read_text().format(**facts))


def _facts(episode: ImportedEpisode) -> dict:
    file = episode.replayed.file
    start = file.model_dump(include={"split", "session", "salt"})
    who = file.model_dump(include={"user", "consent", "study"})
    shown = {"finished": episode.replayed.finished, "preference": episode.label}
    implied = episode.implied
    explained = {"share_of_preference": round(implied.share, 4), "ordered_pairs": implied.ordered}
    return start | who | shown | explained
