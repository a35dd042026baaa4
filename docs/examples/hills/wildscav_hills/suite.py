"""The suite of the hills: one short match on each of two steep maps."""

from wildscav_engine.arithmetic.random_numbers import RandomStream
from wildscav_engine.specs.map_spec import MapConfig
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_evaluator.suites.suite import Suite, TrackSettings


def hilly(dice: RandomStream) -> MapConfig:
    """Return a map of 60 m without houses."""
    return MapConfig(size=60, houses=0, relief=1.0 + 0.1 * dice.integer(0, 5), vegetation=0.0, water=0.0)


def climb(dice: RandomStream) -> MatchSpec:
    """Return a match of three seconds."""
    return MatchSpec(track="summit", time_limit=3.0, metrics=("pace",))


HILLS = Suite(
    name="hills",
    title="short climbs",
    map_config=hilly,
    tracks={"summit": TrackSettings(maps=2, episodes=1, draw=climb)},
)
