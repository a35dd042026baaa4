"""Suites: the seeded lists of matches that evaluate a submission on a track.

A suite is drawn from (track, suite name, seed) without generating any map, and is the same for every
submission. All play the same matches, so that their scores can be compared match by match.

A suite is an object that ``SUITES`` names, or another package in the entry-point group ``wildscav.suites``;
an organizer's own may also be a TOML file (``suite_file.py``).

Map seeds with the top bit set (2**63 and above) are reserved for evaluation. Training draws its map seeds
below 2**63, so no agent has trained on a map of a suite.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from hashlib import blake2b
from typing import Any, NamedTuple

from wildscav.errors import UserError
from wildscav_engine.arithmetic.random_numbers import RandomStream, Stream
from wildscav_engine.extensions import Registry
from wildscav_engine.specs.map_spec import MapConfig, MapSpec
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_engine.specs.thinking import ClockChoice
from wildscav_evaluator.bounds import MAX_MATCHES
from wildscav_evaluator.sandbox.limits import Limits

EVALUATION_MAPS = 1 << 63  # the bit that reserves a map seed for evaluation


class TrackSettings(NamedTuple):
    """The maps and matches of a suite on one track."""

    maps: int
    episodes: int  # on each map
    draw: Callable[[RandomStream], MatchSpec]  # draws everything of a match except its map and seed
    known_maps: tuple[MapSpec, ...] = ()  # as many as ``maps``; played instead of drawn maps
    map_config: Callable[[RandomStream], MapConfig] | None = (
        None  # draws the config of a map; None: the suite's
    )


class Reference(NamedTuple):
    """Which scores on a track are normalized to 0 and 1: the means of two agents, frozen with the suite."""

    agent: str  # the baseline whose score is 1
    zero: float  # the score of the baseline ``random``
    one: float

    def normalized(self, score: float) -> float:
        """Return a score on this scale, whichever direction of it is better."""
        return (score - self.zero) / (self.one - self.zero)


@dataclass(frozen=True)
class Suite:
    """A suite: its kind of maps, and its matches on every track."""

    name: str
    title: str
    map_config: Callable[[RandomStream], MapConfig]
    tracks: Mapping[str, TrackSettings]
    source: bytes | None = None  # the file of an organizer's own suite
    limits: Mapping[str, Limits] = field(
        default_factory=dict
    )  # of agents, for tracks with limits of their own
    version: str = ""  # of the package that it comes from, if that is not Wildscav
    # By track, a digest of what an organizer's own suite says of it: whatever else is in the file may change.
    fingerprints: Mapping[str, str] = field(default_factory=dict)
    clock: ClockChoice | None = None  # of all matches, instead of their own
    # By track; a suite that has them for all its tracks rates submissions across them.
    references: Mapping[str, Reference] = field(default_factory=dict)

    @property
    def label(self) -> str:
        """What identifies it: its name, with a digest of its file or the version of its package."""
        if self.source is not None:
            return f"{self.name}@{blake2b(self.source, digest_size=4).hexdigest()}"
        return f"{self.name}@{self.version}" if self.version else self.name

    def matches(self, track: str, seed: int) -> tuple[MatchSpec, ...]:
        """Return the matches that evaluate a submission on a track; each seed gives other maps and matches.

        UserError if they do not all ask for the same metrics, so that they have no mean.
        """
        settings = self.tracks[track]
        clock = {} if self.clock is None else dict(self.clock)
        dice, map_config = _dice(track, self.name, seed), settings.map_config or self.map_config
        specs = []
        for number in range(settings.maps):
            if settings.known_maps:
                game_map = settings.known_maps[number]
            else:
                game_map = MapSpec(config=map_config(dice), seed=EVALUATION_MAPS | dice.word())
            for _ in range(settings.episodes):
                match = settings.draw(dice)
                specs.append(match.model_copy(update={"map": game_map, "seed": dice.word()} | clock))
        if len({spec.metrics for spec in specs}) > 1:
            raise UserError(f"suite {self.name}: the matches of {track} ask for different metrics")
        return tuple(specs)


def check_suite(name: str, suite: Any) -> Suite:
    """Return the suite that an entry point names, with its package's version; ValueError if it is none."""
    if not isinstance(suite, Suite):
        raise ValueError("it is no Suite")
    if suite.name != name:
        raise ValueError(f"it is called {suite.name!r}")
    origin = SUITES.origin(name)
    return suite if origin is None else replace(suite, version=origin.version)


SUITES: Registry[Suite] = Registry(
    "wildscav.suites",
    {
        "quick": "wildscav_evaluator.suites.quick:QUICK",
        "official": "wildscav_evaluator.suites.official:OFFICIAL",
        "wild": "wildscav_evaluator.suites.wild:WILD",
        "fair": "wildscav_evaluator.suites.wild:FAIR",
        "reading": "wildscav_evaluator.suites.reading:READING",
    },
    check_suite,
)


def suite(track: str, name: str, seed: int) -> tuple[MatchSpec, ...]:
    """Return the matches of a suite on a track, by their names; ValueError if there is no such one."""
    if name not in SUITES:
        raise ValueError(f"there is no suite {name!r}; the suites are {', '.join(SUITES)}")
    chosen = SUITES[name]
    if track not in chosen.tracks:
        raise ValueError(f"suite {name} has no track {track!r}; it has {', '.join(chosen.tracks)}")
    return chosen.matches(track, seed)


def _dice(track: str, name: str, seed: int) -> RandomStream:
    """Return dice that no other track, suite or seed shares."""
    digest = blake2b(f"{name}/{track}/{seed}".encode(), digest_size=8).digest()
    return RandomStream(int.from_bytes(digest, "little"), Stream.SUITE)


def matches_in_rounds(suite: Suite, track: str, seed: int, rounds: int) -> tuple[MatchSpec, ...]:
    """Return the matches of a suite on a track, played in rounds of consecutive seeds."""
    match_count(suite, track, rounds)
    return tuple(spec for turn in range(rounds) for spec in suite.matches(track, seed + turn))


def match_count(suite: Suite, track: str, rounds: int) -> int:
    """Return how many matches a suite has on a track; UserError if there are too many."""
    settings = suite.tracks[track]
    count = settings.maps * settings.episodes * rounds
    if count > MAX_MATCHES:
        raise UserError(
            f"suite {suite.name} has {count:,} matches of {track} in {rounds:,} rounds; at most "
            f"{MAX_MATCHES:,} are allowed",
            exit_code=2,
        )
    return count
