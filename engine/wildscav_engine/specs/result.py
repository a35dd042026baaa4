"""The result of a match, computed from engine state alone."""

from wildscav_engine.specs.base import Spec


class SeatResult(Spec):
    """What one seat achieved."""

    seat: int
    filled_by: str  # "submission" or a robot's name
    team: int
    supplies: int  # carried at the end
    kills: int
    deaths: int
    shots: int
    hits: int
    walked: float  # m
    metrics: dict[str, float]  # keys: the names in Track.metrics


class MatchResult(Spec):
    """The outcome of a match."""

    track: str
    frames: int
    steps: int
    ending: str = "none"  # the name of an Ending: "none", "time_up", "goal" or "last_standing"
    seats: tuple[SeatResult, ...]
