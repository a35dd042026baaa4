"""The match server: many matches at once in one event loop, with one stream per seat."""

from wildscav.server.endpoints.endpoint import EndpointSettings
from wildscav.server.hosting.hosted_match import HostedMatch, MatchCancelledError
from wildscav.server.hosting.reports import Fault, MatchOutcome, SeatReport, SeatStatus, ThinkTime
from wildscav.server.match_server import MatchServer
from wildscav.time_limits import Clock

__all__ = [
    "Clock",
    "EndpointSettings",
    "Fault",
    "HostedMatch",
    "MatchCancelledError",
    "MatchOutcome",
    "MatchServer",
    "SeatReport",
    "SeatStatus",
    "ThinkTime",
]
