"""Routes of matches, and of what can be seen of them."""

from typing import Annotated, Any

from fastapi import APIRouter, Query, Request
from fastapi.responses import FileResponse, PlainTextResponse, Response
from sqlalchemy.orm import Session

from wildscav_leaderboard.access.requests import (
    AnyProgram,
    CurrentSeason,
    KnownProgram,
    Now,
    Reading,
    Renders,
)
from wildscav_leaderboard.accounts.service import Caller
from wildscav_leaderboard.api.submissions import shown_log
from wildscav_leaderboard.matches.listing import MOST, list_matches
from wildscav_leaderboard.matches.models import PLAYING, Match, MatchResult, MatchSeat
from wildscav_leaderboard.matches.records import path_of_record, record_path
from wildscav_leaderboard.matches.service import find_match
from wildscav_leaderboard.matches.visibility import hidden_why, live_hidden_why, twin_of
from wildscav_leaderboard.presentation.documents import REFUSALS, MatchList, MatchView
from wildscav_leaderboard.presentation.matches import match_views
from wildscav_leaderboard.seasons.refusals import ForbiddenError, NotFoundError
from wildscav_leaderboard.spectating.live import LiveMatches, key_of
from wildscav_leaderboard.spectating.render_cache import Progress
from wildscav_leaderboard.spectating.responses import NO_STORE, file_response, progress_response
from wildscav_leaderboard.submissions.listing import is_own
from wildscav_leaderboard.submissions.models import Submission

router = APIRouter(tags=["matches"])
Number = Annotated[int, Query(ge=1, le=2**53)]
RENDERED: dict[int | str, dict[str, Any]] = {
    202: {"description": "It is being rendered: ask again in a moment."},
    503: {"description": "It could not be rendered."},
}
KEPT = {"Cache-Control": "public, max-age=86400, immutable"}  # a match that is over never changes


@router.get("/matches")
def matches(
    caller: AnyProgram,
    session: Reading,
    submission: Number | None = None,
    track: str | None = None,
    state: str | None = None,
    before: Number | None = None,
    limit: Annotated[int, Query(ge=1, le=MOST)] = MOST,
) -> MatchList:
    """List matches, the newest first."""
    found = list_matches(session, submission=submission, track=track, state=state, before=before, limit=limit)
    more = None
    if len(found) == limit:
        chosen = {"submission": submission, "track": track, "state": state}
        others = "".join(f"&{name}={value}" for name, value in chosen.items() if value is not None)
        more = f"/api/v1/matches?before={found[-1].id}&limit={limit}{others}"
    return MatchList(matches=match_views(session, found, caller), next=more)


@router.get("/matches/{match}")
def match(match: int, caller: AnyProgram, session: Reading) -> MatchView:
    """Return a match."""
    return match_views(session, [find_match(session, match)], caller)[0]


@router.get("/matches/{match}/record", response_class=FileResponse)
def record(match: int, caller: AnyProgram, session: Reading, season: CurrentSeason) -> Response:
    """Return the record of a match, from which anyone can play it again."""
    path = record_path(session, season, match, caller)
    return FileResponse(
        path, media_type="application/octet-stream", filename=f"match-{match}.wsr", headers=KEPT
    )


@router.get("/matches/{match}/trails", responses=RENDERED)
def trails(
    match: int,
    request: Request,
    caller: AnyProgram,
    session: Reading,
    season: CurrentSeason,
    renders: Renders,
    now: Now,
    after: Annotated[str, Query(max_length=40)] = "",
) -> Response:
    """Return where everyone was at all times, what happened, and the map's size, as one document.

    Of a match that is being played, return what came after a cursor, which is in the document before.
    """
    found = find_match(session, match)
    if found.state == PLAYING and not live_hidden_why(session, found):
        live: LiveMatches = request.app.state.live
        told = live.trails(key_of(match), after)
        if told is None:
            return progress_response(Progress("waiting", "The match begins or ends in a moment …"))
        return Response(told.model_dump_json(), media_type="application/json", headers=NO_STORE)
    path = record_path(session, season, match, caller)
    return file_response("trails", renders.progress("trails", str(match), path, now))


@router.get("/matches/{match}/overview.webp", responses=RENDERED)
def overview(
    match: int, caller: AnyProgram, session: Reading, season: CurrentSeason, renders: Renders, now: Now
) -> Response:
    """Return the map of a match from above."""
    found = find_match(session, match)
    twin = twin_of(session, found)
    if twin is not None and not live_hidden_why(session, found):  # its record will be of the same map
        match, path = twin.id, path_of_record(session, season, twin.id)
    else:
        path = record_path(session, season, match, caller)
    return file_response("overview", renders.progress("overview", str(match), path, now))


@router.get("/matches/{match}/replay", responses=RENDERED)
def replay(
    match: int, caller: AnyProgram, session: Reading, season: CurrentSeason, renders: Renders, now: Now
) -> Response:
    """Have the replay of a match rendered, and return how far it is."""
    path = record_path(session, season, match, caller)
    return progress_response(renders.progress("replay", str(match), path, now))


@router.get("/matches/{match}/replay.rrd", responses=RENDERED)
def replay_file(
    match: int, caller: AnyProgram, session: Reading, season: CurrentSeason, renders: Renders, now: Now
) -> Response:
    """Return the replay of a match, to watch in Rerun, once it is rendered."""
    path = record_path(session, season, match, caller)
    return file_response("replay", renders.progress("replay", str(match), path, now))


@router.get("/matches/{match}/poster.jpg", responses=RENDERED)
def poster(
    match: int, caller: AnyProgram, session: Reading, season: CurrentSeason, renders: Renders, now: Now
) -> Response:
    """Return one picture of a match, at the moment that shows most."""
    path = record_path(session, season, match, caller)
    return file_response("poster", renders.progress("poster", str(match), path, now))


@router.get("/matches/{match}/video", responses=RENDERED)
def video(
    match: int, caller: AnyProgram, session: Reading, season: CurrentSeason, renders: Renders, now: Now
) -> Response:
    """Have the video of a match rendered, and return how far it is."""
    path = record_path(session, season, match, caller)
    return progress_response(renders.progress("video", str(match), path, now))


@router.get("/matches/{match}/video.mp4", responses=RENDERED)
def video_file(
    match: int, caller: AnyProgram, session: Reading, season: CurrentSeason, renders: Renders, now: Now
) -> Response:
    """Return the video of a match, or the piece of it that the header Range asks for, once it is rendered."""
    path = record_path(session, season, match, caller)
    return file_response("video", renders.progress("video", str(match), path, now))


@router.get("/matches/{match}/logs/{seat}", response_class=PlainTextResponse, responses=REFUSALS)
def logs(match: int, seat: int, caller: KnownProgram, session: Reading, season: CurrentSeason) -> str:
    """Return what an agent of your team printed in a match."""
    found, place = find_match(session, match), session.get(MatchSeat, (match, seat))
    owner = None if place is None or place.submission_id is None else place.submission_id
    if owner is None or not is_own(session, caller, session.get_one(Submission, owner)):
        raise NotFoundError(f"your team has no seat {seat} in match {match}")
    _check_shown(session, found, caller)
    result = session.get_one(MatchResult, match)
    row = next(one for one in result.row["seats"] if one["seat"] == seat)
    if row["log"] is None:
        return "It printed nothing.\n"
    return shown_log(season.match_folder(match) / row["log"])


def _check_shown(session: Session, found: Match, caller: Caller) -> None:
    why = hidden_why(session, found)
    if why and (found.state != "finished" or not caller.is_organizer):
        raise ForbiddenError(why)
