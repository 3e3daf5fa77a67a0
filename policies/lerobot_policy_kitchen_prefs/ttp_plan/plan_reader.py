"""The plan reader: from a user's demonstrations to where each dish goes and when.

It knows a dish only by what it has in common with those that were shown, so it cannot learn the
training users by heart: which colour, which category plays no part.
"""

from math import pi
from typing import NamedTuple

import torch
import torch.nn.functional as F
from torch import Tensor, nn

from ..common.dish_locations import ZONES
from .configuration_ttp_plan import PlanTTPConfig
from .dish_tokens import CATEGORIES, CATEGORY_PART, PlacedDishes
from .evidence import EVIDENCE, Shown, evidence, shown, to_others
from .match_attention import OF_SHOWN, Likeness, MatchLayer, by_head

DESTINATIONS = ZONES + 1  # and the sink
ROOM = 4  # numbers that tell of the room in a zone
HARMONICS = 4  # of the time at which a dish was put away, half a period to four of them
TIME_FEATURES = 2 * (1 + 2 * HARMONICS)  # in the demonstration, and in the turn of its rack
MOMENT = 0.05  # of a demonstration: dishes of one rank follow each other
NEARNESS = 5.0  # 1 / m; dishes on the counter are decimetres apart


class EncodedPrompts(NamedTuple):
    """What the reader knows of G users.

    Attributes:
        dishes: The dishes that were shown.
        known: What was shown of them.
        features: Their features before each layer, (G, n, d) each.
        names: What the reader calls each zone and the sink, (G, 5) int64; see `augmentation`.
    """

    dishes: PlacedDishes
    known: Shown
    features: list[Tensor]
    names: Tensor


class PlanReader(nn.Module):
    """Reads what demonstrations say of dishes.

    destination now ◄─── room in the zones now          turn ◄─── distance from the sink
          ▲                                               ▲
          └───────────── plan of a dish (B, m, d) ────────┘
                                  ▲
    dishes that were shown ──► match layers ◄── dishes that are asked about
          ▲                                               ▲
          └────────── evidence of what was shown ─────────┘
    """

    def __init__(self, config: PlanTTPConfig) -> None:
        """Make the reader of a configuration."""
        super().__init__()
        dim = config.reader_dim
        self.likeness = Likeness()
        self.evidence = nn.Sequential(
            nn.Linear(EVIDENCE, 2 * dim), nn.GELU(), nn.Linear(2 * dim, dim)
        )
        self.put_away = nn.Linear(DESTINATIONS + TIME_FEATURES, dim)
        self.room = RoomInZones()
        self.room_then = nn.Linear(ZONES * ROOM, dim)
        self.room_now = nn.Linear(ZONES * ROOM, dim)
        self.asked = nn.Parameter(torch.zeros(dim))
        self.layers = nn.ModuleList(
            MatchLayer(dim, config.reader_feedforward, config.reader_dropout)
            for _ in range(config.reader_layers)
        )
        self.norm = nn.LayerNorm(dim)
        self.destination = nn.Sequential(
            *(nn.Linear(2 * dim, 2 * dim), nn.GELU()),
            *(nn.Linear(2 * dim, dim), nn.GELU(), nn.Linear(dim, DESTINATIONS)),
        )
        self.rank = nn.Linear(dim, 1)
        self.nearness = nn.Parameter(torch.tensor(1.0))

    def encode(self, dishes: PlacedDishes, names: Tensor) -> EncodedPrompts:
        """Read the dishes of demonstrations, several of a user joined into one.

        Args:
            dishes: Of G users.
            names: What each zone and the sink are called, (G, 5) int64.
        """
        zones = names.gather(1, dishes.zones)  # (G, n)
        where = F.one_hot(zones, DESTINATIONS).to(dishes.times.dtype) * dishes.mask[..., None]
        common = self.likeness(dishes.attributes, dishes.attributes)  # (G, n, n, 8)
        alike = by_head(common) * dishes.mask[:, None, None]  # (G, h, n, n)
        known = shown(alike, where, dishes.preferred().to(where.dtype), dishes.mask)
        features = (
            self.evidence(evidence(to_others(alike), known, where))
            + self.put_away(torch.cat([where, _times(dishes)], dim=-1))
            + self.room_then(self.room(dishes.contents, dishes.attributes, names))
        )  # (G, n, d)
        common = torch.cat([common, _relations(dishes)], dim=-1)  # (G, n, n, 16)
        before = []
        for layer in self.layers:
            before.append(features)
            features = layer(features, features, common, dishes.mask)
        return EncodedPrompts(dishes, known, before, names)

    def plan(self, attributes: Tensor, prompts: EncodedPrompts, prompt_of: Tensor) -> Tensor:
        """What users do with dishes.

        Args:
            attributes: Of the dishes that are asked about, (B, m, 18).
            prompts: What is known of G users.
            prompt_of: Whose dishes they are, (B,) int.

        Returns:
            The plans, (B, m, d).
        """
        dishes = prompts.dishes.select(prompt_of)
        known = Shown(*(part[prompt_of] for part in prompts.known))
        common = self.likeness(attributes, dishes.attributes)  # (B, m, n, 8)
        alike = by_head(common) * dishes.mask[:, None, None]
        features = self.evidence(evidence(alike, known)) + self.asked  # (B, m, d)
        common = F.pad(common, (0, len(OF_SHOWN)))  # (B, m, n, 16)
        for layer, memory in zip(self.layers, prompts.features, strict=True):
            features = layer(features, memory[prompt_of], common, dishes.mask)
        return self.norm(features)

    def destinations(
        self, plans: Tensor, attributes: Tensor, contents: Tensor, names: Tensor
    ) -> Tensor:
        """Where dishes go when something stands in the zones.

        Args:
            plans: (B, m, d).
            attributes: (B, m, 18).
            contents: How many dishes of each category stand in each zone, (B, m, 4, 7).
            names: What the reader calls each zone and the sink, (B, 5) int64.

        Returns:
            Log-probabilities of the zones and of the sink, (B, m, 5).
        """
        room = self.room_now(self.room(contents, attributes, names))  # (B, m, d)
        named = self.destination(torch.cat([plans, room], dim=-1)).log_softmax(dim=-1)
        return named.gather(-1, names[:, None].expand_as(named))

    def turns(self, plans: Tensor, distances: Tensor) -> Tensor:
        """When dishes are loaded, the lowest first: by rank, of one rank by nearness to the sink.

        Args:
            plans: (B, m, d).
            distances: From the sink, (B, m) m.

        Returns:
            (B, m).
        """
        return self.rank(plans)[..., 0] + NEARNESS * self.nearness * distances


class RoomInZones(nn.Module):
    """Tells of the room for a dish in each zone, from what stands there."""

    def __init__(self) -> None:
        """Make the network, which is one for all zones and knows which zone it is."""
        super().__init__()
        self.layers = nn.Sequential(
            *(nn.Linear(2 * CATEGORIES + ZONES, 64), nn.GELU()),
            *(nn.Linear(64, 64), nn.GELU(), nn.Linear(64, ROOM)),
        )

    def forward(self, contents: Tensor, attributes: Tensor, names: Tensor) -> Tensor:
        """Tell of contents (B, m, 4, 7) for dishes (B, m, 18): (B, m, 16), by the zones' names."""
        category = attributes[..., None, CATEGORY_PART].expand_as(contents)
        zone = torch.eye(ZONES, device=contents.device).expand(*contents.shape[:2], -1, -1)
        room = self.layers(torch.cat([contents, category, zone], dim=-1))  # (B, m, 4, ROOM)
        index = names[:, None, :ZONES, None].expand_as(room)
        return torch.zeros_like(room).scatter(2, index, room).flatten(2)


def _times(dishes: PlacedDishes) -> Tensor:
    """When dishes were put away, as numbers, (G, n, 18)."""
    same = dishes.same_rack()
    earlier = dishes.times[:, :, None] > dishes.times[:, None]
    turns = (earlier & same).sum(dim=-1) / (same.sum(dim=-1) - 1).clamp(min=1)  # (G, n)
    return torch.cat([_waves(dishes.times), _waves(turns)], dim=-1)


def _waves(times: Tensor) -> Tensor:
    """Times from 0 to 1, (G, n), with sines and cosines of them, (G, n, 9)."""
    harmonics = pi * 2.0 ** torch.arange(HARMONICS, device=times.device)  # (4,)
    phases = times[..., None] * harmonics  # (G, n, 4)
    return torch.cat([times[..., None], phases.sin(), phases.cos()], dim=-1)


def _relations(dishes: PlacedDishes) -> Tensor:
    """How far pairs of dishes that were shown have each of OF_SHOWN in common, (G, n, n, 8)."""
    together = dishes.together()
    later = dishes.times[:, :, None] - dishes.times[:, None]
    farther = together & (dishes.distances[:, :, None] > dishes.distances[:, None])
    preferred = dishes.preferred().to(later.dtype)
    though_farther = preferred * farther
    pairs = [
        dishes.zones[:, :, None] == dishes.zones[:, None],
        dishes.same_rack(),
        later.sign() * together,
        preferred - preferred.mT,
        though_farther - though_farther.mT,
        farther,
        torch.exp(-(later / MOMENT).square()) * together,
        torch.eye(later.shape[1], device=later.device).expand_as(later),
    ]
    return torch.stack([pair.to(later.dtype) for pair in pairs], dim=-1)
