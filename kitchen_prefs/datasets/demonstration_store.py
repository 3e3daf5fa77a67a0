"""The demonstrations of a data set in memory, as prompts."""

from dataclasses import dataclass
from typing import Self

import numpy as np
import pandas as pd
from lerobot.datasets import LeRobotDataset, LeRobotDatasetMetadata

from kitchen_prefs.datasets.columns import flat_numbers
from kitchen_prefs.envs.lerobot_env import OBS_INSTANCES
from kitchen_prefs.instances import EXTENTS, IS_PLACE, POSE, as_rows, is_real

PREFERENCE = "preference"
CHOSEN_INDEX = "chosen_index"
AT_ONCE = 4096  # frames whose padded sets are held at once: 26 MB in the second tier
PLACE = slice(EXTENTS.start, POSE.stop)  # the columns of a place: the dish's extents, then the pose


class DemonstrationStore:
    """Whole episodes, concatenated.

    Attributes:
        rows: The rows of all decisions of all episodes, (R, D + 1) float32.
        preference: The preference's label of each episode, (E,) int64. On the standard track it
            pairs prompts with situations and is no input to a network.
        places: All distinct places for dishes, chosen or not: extents and pose, (K, 10) float32.
    """

    def __init__(
        self, rows: np.ndarray, lengths: np.ndarray, preference: np.ndarray, places: np.ndarray
    ) -> None:
        """Take the episodes' rows.

        Args:
            rows: The rows of all decisions of all episodes, chosen ones marked, (R, D + 1)
                float32.
            lengths: The number of rows of each episode, (E,) int.
            preference: The preference's label of each episode, (E,) int64.
            places: All distinct places for dishes, (K, 10) float32.
        """
        self.rows = rows
        self.preference = preference
        self.places = places
        self._episodes = np.split(rows, np.cumsum(lengths)[:-1])

    @classmethod
    def read(cls, meta: LeRobotDatasetMetadata, chosen_only: bool) -> Self:
        """Read a data set's episodes.

        Args:
            meta: The data set's metadata.
            chosen_only: Whether to keep only the chosen row of each decision.

        Returns:
            The demonstrations.

        Raises:
            ValueError: If the data set lacks a column that is read.
        """
        wanted = [OBS_INSTANCES, CHOSEN_INDEX, PREFERENCE, "episode_index"]
        missing = sorted(set(wanted) - set(meta.features))
        if missing:
            raise ValueError(
                f"The data set {meta.repo_id!r} has no column {missing[0]!r}; train on a data set "
                "of kitchen_prefs, which has it."
            )
        data = LeRobotDataset(meta.repo_id, root=meta.root, video_backend="pyav")  # has no videos
        frames = data.hf_dataset.with_format("arrow")
        numbers = frames.select_columns(wanted[1:])[:]
        chosen, preference, episode = (flat_numbers(numbers[name]) for name in wanted[1:])
        pieces = []
        for start in range(0, len(chosen), AT_ONCE):
            at_once = slice(start, start + AT_ONCE)
            sets = flat_numbers(frames.select_columns([OBS_INSTANCES])[at_once][OBS_INSTANCES])
            pieces.append(_Piece.of(sets, chosen[at_once], chosen_only))
        episodes, first = np.unique(episode, return_index=True)
        kept = np.concatenate([piece.kept for piece in pieces])
        return cls(
            np.concatenate([piece.rows for piece in pieces]),
            np.bincount(episode, weights=kept).astype(int)[episodes],
            preference[first],
            np.unique(np.concatenate([piece.places for piece in pieces]), axis=0),
        )

    def chosen(self) -> Self:
        """The same demonstrations with only the chosen row of each decision."""
        kept = [rows[rows[:, -1] > 0] for rows in self._episodes]
        lengths = np.array([len(rows) for rows in kept])
        return type(self)(np.concatenate(kept), lengths, self.preference, self.places)

    def draw(self, preference: int, excluded: np.ndarray, generator: np.random.Generator) -> int:
        """Draw an episode of a preference.

        Args:
            preference: The preference's label.
            excluded: The episodes of the batch, which would prompt themselves; they are drawn only
                if there are no others.
            generator: Source of randomness.

        Returns:
            The episode's index.
        """
        episodes = np.flatnonzero(self.preference == preference)
        others = np.setdiff1d(episodes, excluded)
        return int(generator.choice(others if len(others) else episodes))

    def prompts(self, episodes: list[int], length: int | None = None) -> np.ndarray:
        """Make prompts of episodes, as `kitchen_prefs.envs.demonstrations.prompt_of` does.

        Args:
            episodes: The episodes' indices, G of them.
            length: The number P of rows of a prompt; by default that of the longest episode.

        Returns:
            The episodes' rows, zero-padded, (G, P, D + 1) float32.
        """
        rows = [self._episodes[episode] for episode in episodes]
        length = length or max(map(len, rows))
        prompts = np.zeros((len(rows), length, self.rows.shape[1]), dtype=np.float32)
        for prompt, filled in zip(prompts, rows, strict=True):
            prompt[: len(filled)] = filled
        return prompts


@dataclass(frozen=True, eq=False)
class _Piece:
    """What is kept of some frames, t of them.

    Attributes:
        rows: The kept rows, chosen ones marked, (r, D + 1) float32.
        kept: How many of each frame, (t,) int.
        places: The distinct places for dishes, (k, 10) float32.
    """

    rows: np.ndarray
    kept: np.ndarray
    places: np.ndarray

    @classmethod
    def of(cls, numbers: np.ndarray, chosen: np.ndarray, chosen_only: bool) -> Self:
        sets = as_rows(numbers.reshape(len(chosen), -1))  # (t, N, D)
        marks = np.arange(sets.shape[1]) == chosen[:, None]  # (t, N)
        kept = marks if chosen_only else is_real(sets)
        rows = np.concatenate([sets[kept], marks[kept][:, None]], axis=1, dtype=np.float32)
        places = pd.DataFrame(sets[sets[..., IS_PLACE] > 0][:, PLACE]).drop_duplicates()
        return cls(rows, kept.sum(axis=1), places.to_numpy())
