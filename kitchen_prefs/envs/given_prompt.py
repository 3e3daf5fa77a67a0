"""A prompt from outside of the benchmark's sessions, such as a visitor's demonstration."""

import hashlib
from dataclasses import dataclass

import numpy as np

from kitchen_prefs.preferences import Preference


@dataclass(frozen=True, eq=False)
class GivenPrompt:
    """A demonstration that prompts every episode, and whose preference every user then has.

    A split's sessions keep their numbers of dishes; their dishes are drawn for the preference, as
    those of any user are. So a session is the published one where its user has this preference, and
    scores mean what they mean on the split: the expert of the preference is the yardstick.

    Attributes:
        rows: The prompt, zero-padded, (1664, 14) float32.
        preference: The preference that the demonstration follows.
    """

    rows: np.ndarray
    preference: Preference

    @property
    def digest(self) -> str:
        """A hash of the prompt and the preference."""
        sha = hashlib.sha256(self.preference.in_words.encode())
        sha.update(self.rows.tobytes())
        return sha.hexdigest()
