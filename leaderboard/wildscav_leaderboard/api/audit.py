"""Routes of what is published for audits."""

import tempfile
from collections.abc import Iterator
from functools import partial

from fastapi import APIRouter
from fastapi.responses import StreamingResponse

from wildscav_leaderboard.access.rate_limits import DOWNLOADS
from wildscav_leaderboard.access.requests import Address, CurrentSeason, Limits, Reading
from wildscav_leaderboard.publishing.documents import PublishedSeason
from wildscav_leaderboard.publishing.service import Addresses, Audience, board_lines, published_season

router = APIRouter(tags=["audit"])
IN_MEMORY, PIECE = 1 << 20, 64 << 10  # bytes of such a board, beyond which it is in a file; sent at once
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
    session: Reading,
    limits: Limits,
    where: Address,
    audience: Audience = "public",
) -> StreamingResponse:
    """Return a track's board, and the submissions and matches that it follows from, a line each.

    The audience ``season`` is the board as it was before final matches decided it.
    """
    current.track(track)
    limits.use(DOWNLOADS, "audit", where)

    # All of it is read before any of it is sent, so that slow readers keep no connection to the database.
    file = tempfile.SpooledTemporaryFile(IN_MEMORY)  # noqa: SIM115 (it ends with the answer)
    file.writelines(line.text().encode() for line in board_lines(session, current, track, audience))
    file.seek(0)

    def pieces() -> Iterator[bytes]:
        with file:
            yield from iter(partial(file.read, PIECE), b"")

    return StreamingResponse(pieces(), media_type="application/x-ndjson")
