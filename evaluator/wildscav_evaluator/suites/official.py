"""The suite of the original competition: its counts, time limits and supplies, on large maps."""

from wildscav_engine.arithmetic.random_numbers import RandomStream
from wildscav_engine.specs.map_spec import MapConfig
from wildscav_evaluator.suites.match_drawing import battle, capture, choose, gathering, navigation, royale
from wildscav_evaluator.suites.suite import Suite, TrackSettings


def large_map(dice: RandomStream) -> MapConfig:
    """Return the config of a map like the original's large ones: 500 m, 12 to 15 houses of 2 or 3 storeys.

    The terrain ranges from smooth hills to rugged mountains.
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


OFFICIAL = Suite(
    name="official",
    title="the competition's evaluation: its counts, time limits and supplies, on large maps",
    map_config=large_map,
    tracks={
        "navigation": TrackSettings(maps=10, episodes=10, draw=navigation(300.0)),
        "gathering": TrackSettings(
            maps=10,
            episodes=10,
            draw=gathering(600.0, 20.0, (10.0, 30.0, 50.0, 70.0), (5.0, 10.0, 15.0, 20.0)),
        ),
        "battle": TrackSettings(maps=10, episodes=1, draw=battle(900.0, 9, 100.0, 600.0, (30.0, 50.0, 70.0))),
        # Not in the original competition; as long as navigation, the most similar track there.
        "capture": TrackSettings(maps=10, episodes=10, draw=capture(300.0, 3)),
        "royale": TrackSettings(maps=10, episodes=1, draw=royale(900.0, 9)),
    },
)
