"""Matches with seats of words on a match server, which waits for them."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

from numpy.typing import NDArray

from wildscav.errors import UserError
from wildscav_engine.record import RecordError, check_recordable
from wildscav_engine.sensors import allowed_sensors, parse_sensors
from wildscav_engine.simulation.match import Match, MatchSetupError
from wildscav_language.mcp_server.requests import StartMatch, opponents_of, spec_of
from wildscav_language.senses import PICTURE, sensors
from wildscav_server.hosting.hosted_match import HostedMatch
from wildscav_server.hosting.opponents import numbered
from wildscav_server.time_limits import Clock

if TYPE_CHECKING:
    from wildscav_server.match_server import MatchServer

JOIN_TIME = 60.0  # s for baselines to start
IDLE_LIMITS = 6  # that all actions of a seat may take together


async def host(
    server: "MatchServer", request: StartMatch, idle_limit: float
) -> tuple[HostedMatch, dict[int, Path]]:
    """Open a match whose clients have the first seats; return it, and its baselines' folders by their seats.

    A client has ``idle_limit`` s for its next action, after which its seat is closed.

    Raises:
        UserError: It cannot be played.
    """
    opponents = opponents_of(request)
    spec = spec_of(request, opponents)
    others = dict(enumerate(opponents, start=request.clients))
    try:
        check_recordable(spec)
        hosted = await server.host(
            spec,
            names=numbered([*[request.name] * request.clients, *(other.name for other in opponents)]),
            sensors={
                **dict.fromkeys(range(request.clients), sensors()),
                **{seat: other.sensors for seat, other in others.items() if other.sensors},
            },
            clock=Clock(join_timeout=JOIN_TIME, idle_limit=idle_limit, paused_bank=IDLE_LIMITS * idle_limit),
        )
    except (MatchSetupError, RecordError, ValueError) as error:
        raise UserError(f"such a match is not possible: {error}") from None
    return hosted, {seat: other.folder for seat, other in others.items() if other.folder is not None}


def image_of(match: Match, seat: int) -> NDArray[Any]:
    """Return what the camera of a seat shows now, as far as the match's senses allow.

    It is read for those who ask, since a camera in every step would take longer than all else.
    """
    camera = allowed_sensors(parse_sensors({"camera": PICTURE}), match.spec.rules)["camera"]
    camera.prepare(match.game_map)
    image: NDArray[Any] = camera.read(match, [seat])[0]
    return image
