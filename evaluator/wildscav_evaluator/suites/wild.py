"""The suite of hard country: what rules of thumb cannot solve, and fights that cannot be avoided."""

from wildscav_evaluator.suites.suite import Suite, TrackSettings
from wildscav_evaluator.suites.wild_battles import battle, gathering, meeting_ground, royale

WILD = Suite(
    name="wild",
    title="matches that rules of thumb do not win: agents meet at a rich hot spot that moves",
    map_config=meeting_ground,
    tracks={
        "gathering": TrackSettings(maps=10, episodes=2, draw=gathering),
        "battle": TrackSettings(maps=10, episodes=2, draw=battle),
        "royale": TrackSettings(maps=10, episodes=2, draw=royale),
    },
)
