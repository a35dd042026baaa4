"""Routes of what is published for audits."""

from collections.abc import Iterator

from fastapi import APIRouter
from fastapi.responses import StreamingResponse
from limits import RateLimitItemPerMinute

from wildscav_leaderboard.access.requests import CurrentDatabase, CurrentSeason, Reading
from wildscav_leaderboard.api.accounts import Address, Limits
from wildscav_leaderboard.publishing.documents import PublishedSeason
from wildscav_leaderboard.publishing.service import Addresses, Audience, board_lines, published_season

router = APIRouter(tags=["audit"])
DOWNLOADS = RateLimitItemPerMinute(30)  # of boards with all of their matches, by address
ON_SITE = Addresses(
    lines={"public": "tracks/{track}.ndjson", "season": "tracks/{track}.ndjson?audience=season"},
    shown={"public": "../boards/{track}", "season": "../boards/{track}?audience=season"},
    records="../matches/{match}/record",
)


@router.get("/audit/season.json")
def season(current: CurrentSeason, session: Reading) -> PublishedSeason:
    """Return the season for audits: the commitments to its secrets, and where everything else is."""
    return published_season(session, current, ON_SITE)


@router.get(
    "/audit/tracks/{track}.ndjson",
    response_class=StreamingResponse,
    responses={200: {"content": {"application/x-ndjson": {}}}},
)
def track(
    track: str,
    current: CurrentSeason,
    database: CurrentDatabase,
    limits: Limits,
    where: Address,
    audience: Audience = "public",
) -> StreamingResponse:
    """Return a track's board, and the submissions and matches that it follows from, a line each.

    The audience ``season`` is the board as it was before final matches decided it.
    """
    current.track(track)
    limits.use(DOWNLOADS, "audit", where)

    def lines() -> Iterator[str]:
        with database.reading() as session:
            for line in board_lines(session, current, track, audience):
                yield line.text()

    return StreamingResponse(lines(), media_type="application/x-ndjson")
