"""The routes of matches, and of what can be seen of them."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

from fastapi import APIRouter, Depends, Query, Request
from fastapi.responses import FileResponse, JSONResponse, PlainTextResponse, Response, StreamingResponse
from pydantic import Field

from wildscav.terminal.console import printable
from wildscav_engine.specs.map_spec import MapSpec
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_leaderboard.access.requests import (
    Address,
    AnyReader,
    CurrentSeason,
    KnownReader,
    Now,
    Number,
    Reading,
    Renders,
)
from wildscav_leaderboard.api.documents import REFUSALS, MatchList, MatchView
from wildscav_leaderboard.api.match_views import match_views
from wildscav_leaderboard.matches.models import Match
from wildscav_leaderboard.matches.service import MAX_LISTED, find_match, list_matches
from wildscav_leaderboard.seasons.refusals import ForbiddenError, NotFoundError
from wildscav_leaderboard.spectating.kept_notes import sent_notes
from wildscav_leaderboard.spectating.render_cache import Rendering
from wildscav_leaderboard.spectating.streams import Streams
from wildscav_leaderboard.teams.service import find_team
from wildscav_leaderboard.visibility import logs_of_notes, record_path, render_key, seat_log, seen_by
from wildscav_stage.scene.map_file import map_key
from wildscav_stage.scene.notes import Notes

STATUS = {"waiting": 202, "rendering": 202, "failed": 503}
POLL_AFTER = "1"  # s
NO_STORE = {"Cache-Control": "no-store"}
# Browsers ask for a video piece by piece, and begin anew if its tag or its time changes. The time of a file
# in the cache says when it was used last, so a constant one is told.
LONG_AGO = "Thu, 01 Jan 1970 00:00:00 GMT"
# A record never changes, and neither does what is rendered from it.
KEPT = {"Cache-Control": "private, max-age=86400", "X-Content-Type-Options": "nosniff"}
FOR_EVER = "private, max-age=31536000, immutable"  # what an address names exactly
FORMS: Mapping[str, tuple[str, dict[str, str]]] = {
    "trails": ("application/json", {"Content-Encoding": "gzip"}),
    "map": ("application/octet-stream", {"Content-Encoding": "gzip"}),
    "replay": ("application/octet-stream", {}),
    "poster": ("image/jpeg", {}),
    "video": ("video/mp4", {}),
}


def file_response(product: str, progress: Rendering) -> Response:
    """Return a file, or how far it is: 202 while it is rendered, 503 if that failed, with state and detail.

    Args:
        product: A name in ``PRODUCTS``.
    """
    if progress.path is None:
        return progress_response(progress)
    media_type, headers = FORMS[product]
    tag = {"ETag": f'"{progress.path.name}"', "Last-Modified": LONG_AGO}
    return FileResponse(progress.path, media_type=media_type, headers={**KEPT, **tag, **headers})


def progress_response(progress: Rendering) -> Response:
    """Return how far a file is, for a page that polls: 200 once it is ready."""
    headers = NO_STORE if progress.state in ("ready", "failed") else {**NO_STORE, "Retry-After": POLL_AFTER}
    content = {"state": progress.state, "detail": progress.detail}
    return JSONResponse(content, STATUS.get(progress.state, 200), headers)


def map_spec_of(match: Match) -> MapSpec:
    """Return what the map of a match is made of."""
    return MatchSpec.model_validate(match.spec).map


router = APIRouter(tags=["matches"])
LARGEST_LOG = 1 << 20  # bytes
Seat = Annotated[int, Field(ge=0, le=2**53)]
RENDERED: dict[int | str, dict[str, Any]] = {
    202: {"description": "It is being rendered: ask again in a moment."},
    503: {"description": "It could not be rendered."},
}


@router.get("/matches")
def matches(
    caller: AnyReader,
    session: Reading,
    submission: Number | None = None,
    team: str | None = None,
    track: str | None = None,
    state: str | None = None,
    before: Number | None = None,
    limit: Annotated[int, Query(ge=1, le=MAX_LISTED)] = MAX_LISTED,
) -> MatchList:
    """List matches, the newest first."""
    own = None if team is None else find_team(session, team).id
    found = list_matches(
        session, submission=submission, team=own, track=track, state=state, before=before, limit=limit
    )
    more = None
    if len(found) == limit:
        chosen = {"submission": submission, "team": team, "track": track, "state": state}
        others = "".join(f"&{name}={value}" for name, value in chosen.items() if value is not None)
        more = f"/api/v1/matches?before={found[-1].id}&limit={limit}{others}"
    return MatchList(matches=match_views(session, found, caller), next=more)


@router.get("/matches/{match}")
def match(match: Number, caller: AnyReader, session: Reading) -> MatchView:
    """Return a match."""
    return match_views(session, [find_match(session, match)], caller)[0]


@router.get("/matches/{match}/record", response_class=FileResponse)
def record(match: Number, caller: AnyReader, session: Reading, season: CurrentSeason) -> Response:
    """Return the record of a match, from which anyone can play it again."""
    path = record_path(session, season, match, caller)
    return FileResponse(
        path, media_type="application/octet-stream", filename=f"match-{match}.wsr", headers=KEPT
    )


@dataclass(frozen=True)
class RenderRequest:
    """A request for what is rendered from the record of a match."""

    match: Number
    caller: AnyReader
    session: Reading
    season: CurrentSeason
    renders: Renders
    now: Now

    @property
    def is_live(self) -> bool:
        """Whether the match is being played, and the caller may watch it."""
        return not seen_by(self.session, [find_match(self.session, self.match)], self.caller)[self.match].live

    def progress(self, product: str) -> Rendering:
        """Return how far a file is, made from the record if the caller may see it."""
        path = record_path(self.session, self.season, self.match, self.caller)
        return self.renders.progress(product, render_key(self.session, self.match, product), path, self.now)


Asked = Annotated[RenderRequest, Depends()]


@router.get("/matches/{match}/trails", responses=RENDERED)
def trails(asked: Asked) -> Response:
    """Return where everyone was at all times, what happened, and the map's size, as one document."""
    return file_response("trails", asked.progress("trails"))


def sees_everything(asked: Asked) -> bool:
    """Return whether a caller, who may watch a match now, may go on when others may not.

    Raises:
        ForbiddenError: The caller may not watch it, or it is not being played.
    """
    why = seen_by(asked.session, [find_match(asked.session, asked.match)], asked.caller)[asked.match].live
    if why:
        raise ForbiddenError(why)
    return asked.caller is not None and asked.caller.is_organizer


@router.get("/matches/{match}/live", response_class=StreamingResponse, responses=REFUSALS)
async def live(
    request: Request, match: Number, address: Address, everything: Annotated[bool, Depends(sees_everything)]
) -> Response:
    """Return a match that is being played, as server-sent events that go on until it is over.

    `begin` has the document as of `trails`, without its course, and each `news` what came next. A header
    `Last-Event-ID` has the stream go on after the event of that `id`.
    """
    streams: Streams = request.app.state.streams
    return streams.follow(request, match, address, everything=everything)


@router.get("/matches/{match}/map", responses=RENDERED)
def map_of_match(asked: Asked, v: Annotated[str, Query(max_length=40)] = "") -> Response:
    """Return the map of a match: ground, water and solids, as ``scene/map_file.py`` of the stage tells.

    Browsers keep it for ever where the address names this map and no other.
    """
    spec = map_spec_of(find_match(asked.session, asked.match))
    if asked.is_live:
        progress = asked.renders.progress("map", str(asked.match), spec, asked.now)
    else:
        progress = asked.progress("map")
    answer = file_response("map", progress)
    if progress.path is not None and v == map_key(spec):
        answer.headers["Cache-Control"] = FOR_EVER
    return answer


@router.get("/matches/{match}/notes", responses=REFUSALS, response_model=Notes)
def notes(asked: Asked) -> Response:
    """Return what agents said and drew: all of your team, and of others what they made public."""
    logs = logs_of_notes(asked.session, asked.season, asked.match, asked.caller)
    spec = MatchSpec.model_validate(find_match(asked.session, asked.match).spec)
    # They are read when the answer is sent, since the turn of the database is over by then.
    content = sent_notes(logs, spec.frames_per_action)
    return StreamingResponse(content, media_type="application/json", headers={"Content-Encoding": "gzip"})


@router.get("/matches/{match}/replay", responses=RENDERED)
def replay(asked: Asked) -> Response:
    """Have the replay of a match rendered, and return how far it is."""
    return progress_response(asked.progress("replay"))


@router.get("/matches/{match}/replay.rrd", responses=RENDERED)
def replay_file(asked: Asked) -> Response:
    """Return the replay of a match, to watch in Rerun, once it is rendered."""
    return file_response("replay", asked.progress("replay"))


@router.get("/matches/{match}/poster.jpg", responses=RENDERED)
def poster(asked: Asked) -> Response:
    """Return one picture of a match, at the moment that shows most."""
    return file_response("poster", asked.progress("poster"))


@router.get("/matches/{match}/video", responses=RENDERED)
def video(asked: Asked) -> Response:
    """Have the video of a match rendered, and return how far it is."""
    return progress_response(asked.progress("video"))


@router.get("/matches/{match}/video.mp4", responses=RENDERED)
def video_file(asked: Asked) -> Response:
    """Return the video of a match, or the piece of it that the header Range asks for, once it is rendered."""
    return file_response("video", asked.progress("video"))


@router.get("/matches/{match}/logs/{seat}", response_class=PlainTextResponse, responses=REFUSALS)
def logs(match: Number, seat: Seat, caller: KnownReader, session: Reading, season: CurrentSeason) -> str:
    """Return what an agent of your team printed in a match."""
    log = seat_log(session, season, match, seat, caller)
    return "It printed nothing.\n" if log is None else shown_log(log)


def shown_log(path: Path) -> str:
    """Return what an agent printed, without characters that could control a terminal.

    Raises:
        NotFoundError: It is gone.
    """
    try:
        with path.open("rb") as file:
            content = file.read(LARGEST_LOG)
    except FileNotFoundError:
        raise NotFoundError("this log is no longer in the season's files") from None
    return printable(content.decode("utf-8", "replace"), keep="\n\t")
