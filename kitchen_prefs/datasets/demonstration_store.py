"""The demonstrations of a data set in memory, as prompts."""

from typing import Self

import numpy as np
import pandas as pd
from lerobot.datasets import LeRobotDataset, LeRobotDatasetMetadata

from kitchen_prefs.datasets.columns import flat_numbers
from kitchen_prefs.envs.lerobot_env import OBS_INSTANCES
from kitchen_prefs.instances import COLUMNS, EXTENTS, IS_PLACE, POSE, PROMPT_COLUMNS, is_real

PREFERENCE = "preference"
CHOSEN_INDEX = "chosen_index"
PLACE = slice(EXTENTS.start, POSE.stop)  # the columns of a place: the dish's extents, then the pose


class DemonstrationStore:
    """Whole episodes, concatenated.

    Attributes:
        rows: The rows of all decisions of all episodes, (R, 14) float32.
        preference: The preference's label of each episode, (E,) int64. On the standard track it
            pairs prompts with situations and is no input to a network.
        places: All distinct places for dishes, chosen or not: extents and pose, (K, 10) float32.
    """

    def __init__(
        self, rows: np.ndarray, lengths: np.ndarray, preference: np.ndarray, places: np.ndarray
    ) -> None:
        """Take the episodes' rows.

        Args:
            rows: The rows of all decisions of all episodes, chosen ones marked, (R, 14) float32.
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
        table = frames.select_columns(wanted)[:]
        chosen, preference, episode = (flat_numbers(table[name]) for name in wanted[1:])
        sets = flat_numbers(table[OBS_INSTANCES]).reshape(len(chosen), -1, COLUMNS)  # (T, N, 13)
        marks = np.arange(sets.shape[1]) == chosen[:, None]  # (T, N)
        kept = marks if chosen_only else is_real(sets)
        rows = np.concatenate([sets[kept], marks[kept][:, None]], axis=1, dtype=np.float32)
        episodes, first = np.unique(episode, return_index=True)
        lengths = np.bincount(episode, weights=kept.sum(axis=1)).astype(int)[episodes]
        places = pd.DataFrame(sets[sets[..., IS_PLACE] > 0][:, PLACE]).drop_duplicates()
        return cls(rows, lengths, preference[first], np.unique(places, axis=0))

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
            The episodes' rows, zero-padded, (G, P, 14) float32.
        """
        rows = [self._episodes[episode] for episode in episodes]
        length = length or max(map(len, rows))
        prompts = np.zeros((len(rows), length, PROMPT_COLUMNS), dtype=np.float32)
        for prompt, filled in zip(prompts, rows, strict=True):
            prompt[: len(filled)] = filled
        return prompts
