"""The suite for a first impression of an agent: a few short matches on small maps."""

from wildscav_engine.arithmetic.random_numbers import RandomStream
from wildscav_engine.specs.map_spec import MapConfig
from wildscav_engine.tracks import TRACKS
from wildscav_evaluator.suites.match_drawing import (
    battle,
    capture,
    choose,
    gathering,
    navigation,
    royale,
    track_defaults,
)
from wildscav_evaluator.suites.suite import Suite, TrackSettings


def small_map(dice: RandomStream) -> MapConfig:
    """Return the config of a map that is generated quickly: 60 to 100 m with up to three houses."""
    size = choose(dice, (60, 80, 100))
    return MapConfig(
        size=size,
        # On 60 m of steep terrain there is not always space for more.
        houses=dice.integer(2, 3) if size > 60 else 1,
        density="high" if dice.integer(0, 1) else "low",
        storeys=(1, 2),
        relief=choose(dice, (0.5, 0.8, 1.1)),
        ruggedness=choose(dice, (0.1, 0.4, 0.8)),
        water=choose(dice, (0.0, 0.06)),
        vegetation=choose(dice, (0.2, 0.4)),
    )


_CHOSEN = {
    "navigation": TrackSettings(maps=5, episodes=1, draw=navigation(60.0)),
    "gathering": TrackSettings(maps=4, episodes=1, draw=gathering(60.0, 10.0, (10.0, 30.0), (5.0, 10.0))),
    "capture": TrackSettings(maps=3, episodes=1, draw=capture(60.0, 3)),
    "battle": TrackSettings(maps=3, episodes=1, draw=battle(60.0, 5, 40.0, 40.0, (10.0, 20.0))),
    "royale": TrackSettings(maps=3, episodes=1, draw=royale(60.0, 5)),
}
# Every other installed track is played with the defaults of its class.
_OTHERS = {
    name: TrackSettings(maps=3, episodes=1, draw=track_defaults(name, 60.0, 5))
    for name in TRACKS
    if name not in _CHOSEN
}

QUICK = Suite(
    name="quick",
    title="a look at an agent in a minute or two: few short matches on small maps",
    map_config=small_map,
    tracks=_CHOSEN | _OTHERS,
)
