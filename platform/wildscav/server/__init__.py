"""The match server: many matches at once in one event loop, one stream a seat."""

from wildscav.server.deadlines import Clock
from wildscav.server.entrance import Door
from wildscav.server.reports import Fault, MatchOutcome, SeatReport, SeatStatus, ThinkTime, Thought
from wildscav.server.server import MatchServer
from wildscav.server.session import HostedMatch, MatchCancelledError

__all__ = [
    "Clock",
    "Door",
    "Fault",
    "HostedMatch",
    "MatchCancelledError",
    "MatchOutcome",
    "MatchServer",
    "SeatReport",
    "SeatStatus",
    "ThinkTime",
    "Thought",
]
