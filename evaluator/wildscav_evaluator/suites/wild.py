"""The suite of hard country: what rules of thumb cannot solve, and fights that cannot be avoided."""

from wildscav_engine.arithmetic.random_numbers import Dice
from wildscav_engine.maps.pools import LEVELS
from wildscav_engine.specs.map_spec import MapConfig
from wildscav_evaluator.suites.match_drawing import capture, navigation
from wildscav_evaluator.suites.suite import Suite, TrackSettings
from wildscav_evaluator.suites.wild_battles import battle, gathering, meeting_ground, royale

TIME_LIMIT = 120.0  # s, four times what the longest ways take at full speed


def expert_map(_: Dice) -> MapConfig:
    """Return the config of maps at level expert: few ways lead through them, and targets are hidden."""
    return LEVELS["expert"]


WILD = Suite(
    name="wild",
    title="matches that rules of thumb do not win: mazes to cross, and agents that meet at a rich hot spot",
    map_config=meeting_ground,
    tracks={
        "navigation": TrackSettings(maps=25, episodes=4, draw=navigation(TIME_LIMIT), map_config=expert_map),
        "capture": TrackSettings(maps=25, episodes=4, draw=capture(TIME_LIMIT, 3), map_config=expert_map),
        "gathering": TrackSettings(maps=10, episodes=2, draw=gathering),
        "battle": TrackSettings(maps=10, episodes=2, draw=battle),
        "royale": TrackSettings(maps=10, episodes=2, draw=royale),
    },
)
