"""Dishes as the plan reader sees them: what they are, and where and when they were put away.

Of a demonstration two rows a dish say it: the dish when it is picked, and the place that is chosen
for it, which has its attributes too. When it arrived is when it was first visible.
"""

from itertools import batched
from typing import NamedTuple, Self

import torch
import torch.nn.functional as F
from torch import Tensor

from kitchen_prefs.datasets.demonstration_store import DemonstrationStore
from kitchen_prefs.envs.observations import EXTENTS as CATEGORY_EXTENTS
from kitchen_prefs.instances import DECISION, EXTENTS, IS_PLACE, MATERIAL, POSITION, RGB, SOIL
from kitchen_prefs.simulation.layout import SINK_CENTRE

from ..common.categories import category_at_any_size
from ..common.dish_locations import ELSEWHERE, ZONES, in_rack, on_counter, zone_of
from ..common.instance_sets import is_dish, select_rows

EXTENTS_OF = torch.from_numpy(CATEGORY_EXTENTS)  # (7, 3)
CATEGORIES = len(EXTENTS_OF)

# The columns of attributes.
CATEGORY_PART, MATERIAL_PART = slice(0, 7), slice(7, 11)
COLOUR_PART, SOIL_PART, SIZE_PART = slice(11, 14), slice(14, 15), slice(15, 18)
ATTRIBUTES = 18
USUAL_LENGTH = 0.14  # m, an eighth of e below the mean: lengths have logarithms about 0
EXACT = "donot_use_mm_for_euclid_dist"  # the other way errs by a millimetre
AT_ONCE = 64  # episodes; a thousand rows each are compared with its dishes
UNMOVED = 1e-3  # m; a dish stays where it is on the counter until it is picked


class PlacedDishes(NamedTuple):
    """What G demonstrations do with their n dishes, in the order in which they are put away.

    Attributes:
        attributes: See `attributes_of`, (G, n, 18).
        distances: How far each stood from the sink, (G, n) m.
        zones: Where each was put, (G, n) int64, ELSEWHERE for the sink.
        arrivals: The decision at which it was first visible, (G, n).
        decisions: The decision at which it was picked, (G, n).
        times: The same as a share of the demonstration, (G, n).
        contents: How many dishes of each category stood in each zone then, (G, n, 4, 7).
        mask: Which dishes are real, (G, n) bool.
        demonstration: The demonstration of each, where several are joined, (G, n) int64.
    """

    attributes: Tensor
    distances: Tensor
    zones: Tensor
    arrivals: Tensor
    decisions: Tensor
    times: Tensor
    contents: Tensor
    mask: Tensor
    demonstration: Tensor

    def joined(self, count: int) -> Self:
        """The dishes of every `count` demonstrations as those of one."""
        number = torch.arange(len(self.mask), device=self.mask.device) % count
        numbered = self._replace(demonstration=number[:, None].expand_as(self.demonstration))
        return type(self)(*(part.unflatten(0, (-1, count)).flatten(1, 2) for part in numbered))

    def select(self, which: Tensor) -> Self:
        """Some of the demonstrations, by index or mask."""
        return type(self)(*(part[which] for part in self))

    def with_others(self, others: Self) -> Self:
        """The dishes with those of another demonstration of each user."""
        parts = (torch.cat(pair, dim=1) for pair in zip(self, others, strict=True))
        return type(self)(*parts)

    def only(self, shown: Tensor) -> Self:
        """The same demonstrations as if there were no other dishes than some, (G, n) bool."""
        mask = self.mask & shown
        contents = _contents_before(self.attributes, self.zones, mask)
        return self._replace(mask=mask, contents=contents)

    def contents_at(self, decision: Tensor) -> Tensor:
        """What stands in the zones before a decision of each demonstration, (G,): (G, 4, 7)."""
        put_away = self.mask & (self.decisions + 1 < decision[:, None])  # (G, n)
        return (_stands(self.attributes, self.zones) * put_away[..., None, None]).sum(dim=1)

    def same_rack(self) -> Tensor:
        """Which pairs of dishes are in one rack, or both in the sink, (G, n, n) bool."""
        racks = self.zones // 2  # the sink counts as a third
        return self.together() & (racks[:, :, None] == racks[:, None])

    def together(self) -> Tensor:
        """Which pairs of dishes are of one demonstration, (G, n, n) bool."""
        both = self.mask[:, :, None] & self.mask[:, None]
        return both & (self.demonstration[:, :, None] == self.demonstration[:, None])

    def preferred(self) -> Tensor:
        """Where a dish was picked although another waited that went into its rack, (G, n, n)."""
        waited = self.arrivals[:, None] <= self.decisions[:, :, None]
        first = self.decisions[:, :, None] < self.decisions[:, None]
        racked = self.zones < ELSEWHERE
        return self.same_rack() & waited & first & racked[:, :, None]


def placed_dishes(demonstrations: Tensor) -> PlacedDishes:
    """The dishes of demonstrations.

    Args:
        demonstrations: Zero-padded, the last column marks the chosen rows, (G, P, 22).
    """
    chosen = demonstrations[..., -1] > 0  # (G, P)
    placed, mask = select_rows(demonstrations, chosen & (demonstrations[..., IS_PLACE] > 0))
    dishes = is_dish(demonstrations) & on_counter(demonstrations)  # (G, P)
    picked, _ = select_rows(demonstrations, chosen & dishes)
    picked = picked[:, : placed.shape[1]]  # a last dish may still be in the hand
    attributes, zones = attributes_of(placed), zone_of(placed)
    length = demonstrations[..., DECISION].amax(dim=1, keepdim=True).clamp(min=1)  # (G, 1)
    return PlacedDishes(
        attributes=attributes,
        distances=distances_to_sink(picked),
        zones=zones,
        arrivals=_first_visible(picked, demonstrations, dishes),
        decisions=picked[..., DECISION],
        times=picked[..., DECISION] / length,
        contents=_contents_before(attributes, zones, mask),
        mask=mask,
        demonstration=torch.zeros_like(zones),
    )


def read_placed(store: DemonstrationStore) -> PlacedDishes:
    """The dishes of all episodes of a data set, of which the store has all rows."""
    episodes = range(len(store.preference))
    pieces = [
        placed_dishes(torch.from_numpy(store.prompts(list(piece))))
        for piece in batched(episodes, AT_ONCE)
    ]
    most = max(piece.mask.shape[1] for piece in pieces)
    fields = zip(*pieces, strict=True)
    return PlacedDishes(*(torch.cat([_padded(part, most) for part in field]) for field in fields))


def _padded(part: Tensor, length: int) -> Tensor:
    """A part of some demonstrations, (G, n, ...), padded to more dishes."""
    added = part.new_zeros(len(part), length - part.shape[1], *part.shape[2:])
    return torch.cat([part, added], dim=1)


def attributes_of(rows: Tensor) -> Tensor:
    """What the dishes, or places for them, of rows (..., D) are, (..., 18).

    Category and material as one of several, the colour's RGB, soil, and the logarithms of extents.
    """
    category, _ = category_at_any_size(rows, EXTENTS_OF.to(rows))  # (...)
    return torch.cat(
        [
            F.one_hot(category, CATEGORIES).to(rows.dtype),
            rows[..., MATERIAL],
            rows[..., RGB],
            rows[..., SOIL, None],
            (rows[..., EXTENTS].clamp(min=1e-3) / USUAL_LENGTH).log(),
        ],
        dim=-1,
    )


def distances_to_sink(rows: Tensor) -> Tensor:
    """How far the middles of rows (..., D) are from the sink, seen from above, (...) m."""
    xy = rows[..., POSITION][..., :2]
    return (xy - xy.new_tensor(SINK_CENTRE)).norm(dim=-1)


def visible_contents(sets: Tensor) -> Tensor:
    """How many dishes of each category stand in each zone as far as sets (B, N, D) show it.

    Returns:
        (B, 4, 7); zeros for a rack that is in.
    """
    stands = _stands(attributes_of(sets), zone_of(sets))  # (B, N, 4, 7)
    return (stands * (is_dish(sets) & in_rack(sets))[..., None, None]).sum(dim=1)


def _stands(attributes: Tensor, zones: Tensor) -> Tensor:
    """Each dish as a count of one in its zone, of none in the sink, (..., 4, 7)."""
    in_zone = F.one_hot(zones, ELSEWHERE + 1)[..., :ZONES].to(attributes.dtype)
    return in_zone[..., None] * attributes[..., None, CATEGORY_PART]


def _contents_before(attributes: Tensor, zones: Tensor, mask: Tensor) -> Tensor:
    """What stands in each zone before each dish of (G, n) is put away, (G, n, 4, 7)."""
    stands = _stands(attributes, zones) * mask[..., None, None]
    return stands.cumsum(dim=1) - stands


def _first_visible(picked: Tensor, demonstrations: Tensor, dishes: Tensor) -> Tensor:
    """The first decision at which dishes (G, n, D) are seen where they are picked, (G, n)."""
    apart = torch.cdist(picked[..., POSITION], demonstrations[..., POSITION], compute_mode=EXACT)
    seen = (apart < UNMOVED) & dishes[:, None]
    decisions = demonstrations[:, None, :, DECISION].expand_as(apart)
    return decisions.masked_fill(~seen, torch.inf).amin(dim=-1)
