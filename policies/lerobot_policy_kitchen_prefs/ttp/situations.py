"""What a decision is made upon: a set of instances, and what is known of the decisions before."""

from typing import NamedTuple, Self

from torch import Tensor

from ..common.instance_sets import is_real


class Situations(NamedTuple):
    """Situations of B decisions.

    Attributes:
        sets: The instance sets, zero-padded, (B, N, 13).
        failed: Which rows were just chosen in vain, (B, N) bool.
        history: The objects that were seen in earlier decisions, zero-padded, (B, H, 13).
    """

    sets: Tensor
    failed: Tensor
    history: Tensor

    def select(self, which: Tensor) -> Self:
        """Some of the situations, by index or mask."""
        return type(self)(self.sets[which], self.failed[which], self.history[which])

    def trimmed(self) -> Self:
        """The same situations without the padding that the longest set does not need."""
        longest = int(is_real(self.sets).sum(dim=1).max())  # padding stands at the end
        return self._replace(sets=self.sets[:, :longest], failed=self.failed[:, :longest])
