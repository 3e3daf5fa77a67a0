"""Augmentation of a batch: other names for colours, materials and zones, slips, other selections.

A permutation of the colours, applied to a user's demonstrations together, makes another user of the
same task; a permutation of the materials one of a like task, in which glasses may be of wood; a
mirror image of the zones one who turns racks round. None changes which kinds of rules a user has,
so no pair of rules arises that training lacks (`people_composed`).
"""

import numpy as np
import torch
from torch import Tensor

from kitchen_prefs.instances import MATERIAL, RGB
from kitchen_prefs.people.attributes import MATERIALS
from kitchen_prefs.people.attributes import RGB as COLOURS

from ..common.dish_locations import ZONES
from .configuration_ttp_plan import PlanTTPConfig
from .dish_tokens import COLOUR_PART, MATERIAL_PART, PlacedDishes
from .plan_reader import DESTINATIONS

SLIPS = 0.1  # of the dishes of a demonstration with slips
FORGOTTEN = 0.4  # at most this share of a demonstration's dishes is not shown, in half of them
SHOWN_OF_OWN = 0.8  # at most this share of an episode's own dishes is


def _name(zone: int, exchange: bool, left: int, top: int) -> int:
    """A zone, 2 rack + side, with sides or racks turned round, or racks and sides exchanged."""
    rack, side = divmod(zone, 2)
    rack, side = rack ^ top, side ^ left
    return 2 * side + rack if exchange else 2 * rack + side


# The eight symmetries of two racks with two halves: what the zones, and the sink, are called.
NAMES = torch.tensor(
    [
        [*(_name(zone, exchange, left, top) for zone in range(ZONES)), ZONES]
        for exchange in (False, True)
        for left in (0, 1)
        for top in (0, 1)
    ]
)


class Augmentation:
    """What is changed for each of B samples.

    Args:
        count: The number B of samples.
        config: The configuration.
        generator: Source of randomness; without it nothing is changed.
        device: Where the samples are.

    Attributes:
        names: What each zone, and the sink, is called in a sample, (B, 5) int64.
    """

    def __init__(
        self,
        count: int,
        config: PlanTTPConfig,
        generator: np.random.Generator | None,
        device: torch.device,
    ) -> None:
        self._generator = generator if config.relabel else None
        self._config = config
        self._device = device
        self.names = torch.arange(DESTINATIONS, device=device).expand(count, -1)
        if self._generator is not None:
            names = torch.from_numpy(self._generator.integers(len(NAMES), size=count))
            self.names = NAMES[names].to(device)
            self._colours = self._permutations(count, len(COLOURS))
            self._materials = self._permutations(count, len(MATERIALS))

    def of_rows(self, rows: Tensor) -> Tensor:
        """Permute the colours and the materials of rows, (B, N, 21) or (B, N, 22)."""
        return self._recolour(rows, RGB, MATERIAL)

    def of_dishes(self, dishes: PlacedDishes) -> PlacedDishes:
        """Permute the colours and the materials of dishes."""
        attributes = self._recolour(dishes.attributes, COLOUR_PART, MATERIAL_PART)
        return dishes._replace(attributes=attributes)

    def of_prompts(self, dishes: PlacedDishes) -> PlacedDishes:
        """Put some dishes of some demonstrations into other zones, and forget some of others.

        A slip is to the other side of the rack, as the other rack was in at that time.
        """
        if self._generator is None:
            return dishes
        shape = tuple(dishes.zones.shape)
        slipped = self._drawn((shape[0], 1), self._config.slip_share) & self._drawn(shape, SLIPS)
        slipped &= dishes.zones < ZONES
        share = self._generator.uniform(0, FORGOTTEN, (shape[0], 1))
        forgotten = self._drawn((shape[0], 1), 0.5) & self._drawn(shape, share)
        zones = (dishes.zones ^ 1).where(slipped, dishes.zones)
        return dishes._replace(zones=zones).only(~forgotten)

    def split(self, own: PlacedDishes) -> tuple[PlacedDishes, PlacedDishes]:
        """Of the samples' own dishes those that are shown too, and those that are asked about.

        To samples that teach decisions none are shown: their decisions are about these dishes.
        """
        if self._generator is None:
            return own._replace(mask=torch.zeros_like(own.mask)), own
        count, n = own.mask.shape
        share = self._generator.uniform(0, SHOWN_OF_OWN, (count, 1))
        shown = self._drawn((count, 1), self._config.own_share) & self._drawn((count, n), share)
        shown[: self._config.decided] = False
        second = torch.ones_like(own.demonstration)
        return (
            own.only(shown)._replace(demonstration=second),
            own._replace(mask=own.mask & ~shown),
        )

    def _recolour(self, rows: Tensor, rgb: slice, material: slice) -> Tensor:
        """Permute the colours and the materials in these columns of rows (B, N, D)."""
        if self._generator is None:
            return rows
        known = torch.from_numpy(COLOURS).to(rows.device)  # (4, 3)
        colour = torch.cdist(rows[..., rgb], known.expand(len(rows), -1, -1)).argmin(-1)  # (B, N)
        described = (rows[..., rgb] > 0).any(dim=-1, keepdim=True)  # (B, N, 1)
        changed = rows.clone()
        changed[..., rgb] = known[self._colours.gather(1, colour)].where(described, rows[..., rgb])
        materials = self._materials[:, None].expand(-1, rows.shape[1], -1)
        changed[..., material] = rows[..., material].gather(2, materials)
        return changed

    def _drawn(self, shape: tuple[int, ...], probability: float | np.ndarray) -> Tensor:
        assert self._generator is not None
        return torch.from_numpy(self._generator.random(shape) < probability).to(self._device)

    def _permutations(self, count: int, size: int) -> Tensor:
        """A permutation of `size` things for each sample, (B, size) int64."""
        assert self._generator is not None
        identity = np.tile(np.arange(size), (count, 1))
        return torch.from_numpy(self._generator.permuted(identity, axis=1)).to(self._device)
