"""Suites: the seeded lists of matches that evaluate a submission on a track.

A suite is made from (track, suite name, seed) without making any map, and is the same for every
submission: all play the same matches, so that their scores can be compared match by match.

Map seeds with the top bit set (2**63 and above) are kept for evaluation. Training draws its map seeds
below 2**63, so no agent has trained on a map of a suite.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from hashlib import blake2b
from typing import NamedTuple

from wildscav_engine.arithmetic.random_numbers import Dice, Stream
from wildscav_engine.specs.map_spec import MapConfig, MapSpec
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_evaluator.sandbox.limits import Limits
from wildscav_evaluator.suites.match_drawing import battle, capture, choose, gathering, navigation, royale

EVALUATION_MAPS = 1 << 63  # the bit that marks a map seed as kept for evaluation


class TrackSettings(NamedTuple):
    """What a suite asks on one track."""

    maps: int
    episodes: int  # on each map
    draw: Callable[[Dice], MatchSpec]  # everything of a match but its map and seed
    known_maps: tuple[MapSpec, ...] = ()  # as many as ``maps``: played instead of maps drawn


@dataclass(frozen=True)
class Suite:
    """A way to evaluate: what kind of maps, and a course for every track."""

    name: str
    title: str
    map_config: Callable[[Dice], MapConfig]
    tracks: Mapping[str, TrackSettings]
    source: bytes | None = None  # the file of an organizer's own suite
    limits: Mapping[str, Limits] = field(default_factory=dict)  # of agents, for tracks that have their own

    @property
    def label(self) -> str:
        """What tells it apart from all others: its name; of an organizer's own, also its file's content."""
        if self.source is None:
            return self.name
        return f"{self.name}@{blake2b(self.source, digest_size=4).hexdigest()}"

    def matches(self, track: str, seed: int) -> tuple[MatchSpec, ...]:
        """Return the matches that evaluate a submission on a track.

        Args:
            track: One of ``tracks``.
            seed: Any whole number; each gives other maps and matches.
        """
        settings = self.tracks[track]
        dice = _dice(track, self.name, seed)
        specs = []
        for number in range(settings.maps):
            if settings.known_maps:
                game_map = settings.known_maps[number]
            else:
                game_map = MapSpec(config=self.map_config(dice), seed=EVALUATION_MAPS | dice.word())
            for _ in range(settings.episodes):
                match = settings.draw(dice)
                specs.append(match.model_copy(update={"map": game_map, "seed": dice.word()}))
        return tuple(specs)


def suite(track: str, name: str, seed: int) -> tuple[MatchSpec, ...]:
    """Return the matches that evaluate a submission on a track.

    Args:
        track: A name in ``wildscav_engine.tracks.TRACKS``.
        name: A name in ``SUITES``.
        seed: Any whole number; each gives other maps and matches.

    Raises:
        ValueError: There is no such suite, or it does not have the track.
    """
    if name not in SUITES:
        raise ValueError(f"there is no suite {name!r}; the suites are {', '.join(SUITES)}")
    chosen = SUITES[name]
    if track not in chosen.tracks:
        raise ValueError(f"suite {name} has no track {track!r}; it has {', '.join(chosen.tracks)}")
    return chosen.matches(track, seed)


def _dice(track: str, name: str, seed: int) -> Dice:
    """Return dice that no other track, suite or seed shares."""
    digest = blake2b(f"{name}/{track}/{seed}".encode(), digest_size=8).digest()
    return Dice(int.from_bytes(digest, "little"), Stream.SUITE)


def _small_map(dice: Dice) -> MapConfig:
    size = choose(dice, (60, 80, 100))
    return MapConfig(
        size=size,
        # On 60 m of steep country there is not always room for more.
        houses=dice.integer(2, 3) if size > 60 else 1,
        density="high" if dice.integer(0, 1) else "low",
        storeys=(1, 2),
        relief=choose(dice, (0.5, 0.8, 1.1)),
        ruggedness=choose(dice, (0.1, 0.4, 0.8)),
        water=choose(dice, (0.0, 0.06)),
        vegetation=choose(dice, (0.2, 0.4)),
    )


def _large_map(dice: Dice) -> MapConfig:
    """A map like the original's large ones: 500 m, 12 to 15 houses of two or three storeys.

    The land itself is anything from smooth downs to rugged mountains.
    """
    return MapConfig(
        size=500,
        houses=dice.integer(12, 15),
        density="high" if dice.integer(0, 1) else "low",
        storeys=(2, 3),
        relief=choose(dice, (0.5, 1.0, 1.5, 2.0)),
        ruggedness=choose(dice, (0.1, 0.4, 0.7, 1.0)),
        water=choose(dice, (0.04, 0.08, 0.12)),
        vegetation=choose(dice, (0.2, 0.4, 0.6)),
    )


_SUITES = (
    Suite(
        name="quick",
        title="a look at an agent in a minute or two: few short matches on small maps",
        map_config=_small_map,
        tracks={
            "navigation": TrackSettings(maps=5, episodes=1, draw=navigation(60.0)),
            "gathering": TrackSettings(
                maps=4, episodes=1, draw=gathering(60.0, 10.0, (10.0, 30.0), (5.0, 10.0))
            ),
            "capture": TrackSettings(maps=3, episodes=1, draw=capture(60.0, 3)),
            "battle": TrackSettings(maps=3, episodes=1, draw=battle(60.0, 5, 40.0, 40.0, (10.0, 20.0))),
            "royale": TrackSettings(maps=3, episodes=1, draw=royale(60.0, 5)),
        },
    ),
    # Counts, limits and supplies of the original competition.
    Suite(
        name="official",
        title="the competition's evaluation: its counts, time limits and supplies, on large maps",
        map_config=_large_map,
        tracks={
            "navigation": TrackSettings(maps=10, episodes=10, draw=navigation(300.0)),
            "gathering": TrackSettings(
                maps=10,
                episodes=10,
                draw=gathering(600.0, 20.0, (10.0, 30.0, 50.0, 70.0), (5.0, 10.0, 15.0, 20.0)),
            ),
            "battle": TrackSettings(
                maps=10, episodes=1, draw=battle(900.0, 9, 100.0, 600.0, (30.0, 50.0, 70.0))
            ),
            # Not in the original competition; as long as its nearest kin there.
            "capture": TrackSettings(maps=10, episodes=10, draw=capture(300.0, 3)),
            "royale": TrackSettings(maps=10, episodes=1, draw=royale(900.0, 9)),
        },
    ),
)
SUITES: dict[str, Suite] = {one.name: one for one in _SUITES}
