"""Routes of matches, and of what can be seen of them."""

from typing import Annotated, Any

from fastapi import APIRouter, Query, Request
from fastapi.responses import FileResponse, PlainTextResponse, Response

from wildscav_leaderboard.access.requests import (
    AnyReader,
    CurrentSeason,
    KnownReader,
    Now,
    Reading,
    Renders,
)
from wildscav_leaderboard.api.submissions import shown_log
from wildscav_leaderboard.matches.listing import MOST, list_matches
from wildscav_leaderboard.matches.models import FINISHED, MatchResult, MatchSeat
from wildscav_leaderboard.matches.records import path_of_record, record_path
from wildscav_leaderboard.matches.service import find_match
from wildscav_leaderboard.matches.visibility import seen_by, twin_of
from wildscav_leaderboard.presentation.documents import REFUSALS, MatchList, MatchView
from wildscav_leaderboard.presentation.matches import match_views
from wildscav_leaderboard.seasons.refusals import ForbiddenError, NotFoundError
from wildscav_leaderboard.spectating.live import LiveMatches, key_of
from wildscav_leaderboard.spectating.render_cache import Progress
from wildscav_leaderboard.spectating.responses import KEPT, NO_STORE, file_response, progress_response
from wildscav_leaderboard.submissions.models import Submission
from wildscav_leaderboard.teams.models import Team

router = APIRouter(tags=["matches"])
Number = Annotated[int, Query(ge=1, le=2**53)]
RENDERED: dict[int | str, dict[str, Any]] = {
    202: {"description": "It is being rendered: ask again in a moment."},
    503: {"description": "It could not be rendered."},
}


@router.get("/matches")
def matches(
    caller: AnyReader,
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
def match(match: int, caller: AnyReader, session: Reading) -> MatchView:
    """Return a match."""
    return match_views(session, [find_match(session, match)], caller)[0]


@router.get("/matches/{match}/record", response_class=FileResponse)
def record(match: int, caller: AnyReader, session: Reading, season: CurrentSeason) -> Response:
    """Return the record of a match, from which anyone can play it again."""
    path = record_path(session, season, match, caller)
    return FileResponse(
        path, media_type="application/octet-stream", filename=f"match-{match}.wsr", headers=KEPT
    )


@router.get("/matches/{match}/trails", responses=RENDERED)
def trails(
    match: int,
    request: Request,
    caller: AnyReader,
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
    if not seen_by(session, [found], caller)[match].live:
        live: LiveMatches = request.app.state.live
        told = live.trails(key_of(match), after)
        if told is None:
            return progress_response(Progress("waiting", "The match begins or ends in a moment …"))
        return Response(told.model_dump_json(), media_type="application/json", headers=NO_STORE)
    path = record_path(session, season, match, caller)
    return file_response("trails", renders.progress("trails", str(match), path, now))


@router.get("/matches/{match}/overview.webp", responses=RENDERED)
def overview(
    match: int, caller: AnyReader, session: Reading, season: CurrentSeason, renders: Renders, now: Now
) -> Response:
    """Return the map of a match from above."""
    found = find_match(session, match)
    twin = twin_of(session, found)
    if (
        twin is not None
        and twin.state == FINISHED
        and not seen_by(session, [found], caller)[match].live  # its record will be of the same map
    ):
        match, path = twin.id, path_of_record(session, season, twin.id)
    else:
        path = record_path(session, season, match, caller)
    return file_response("overview", renders.progress("overview", str(match), path, now))


@router.get("/matches/{match}/replay", responses=RENDERED)
def replay(
    match: int, caller: AnyReader, session: Reading, season: CurrentSeason, renders: Renders, now: Now
) -> Response:
    """Have the replay of a match rendered, and return how far it is."""
    path = record_path(session, season, match, caller)
    return progress_response(renders.progress("replay", str(match), path, now))


@router.get("/matches/{match}/replay.rrd", responses=RENDERED)
def replay_file(
    match: int, caller: AnyReader, session: Reading, season: CurrentSeason, renders: Renders, now: Now
) -> Response:
    """Return the replay of a match, to watch in Rerun, once it is rendered."""
    path = record_path(session, season, match, caller)
    return file_response("replay", renders.progress("replay", str(match), path, now))


@router.get("/matches/{match}/poster.jpg", responses=RENDERED)
def poster(
    match: int, caller: AnyReader, session: Reading, season: CurrentSeason, renders: Renders, now: Now
) -> Response:
    """Return one picture of a match, at the moment that shows most."""
    path = record_path(session, season, match, caller)
    return file_response("poster", renders.progress("poster", str(match), path, now))


@router.get("/matches/{match}/video", responses=RENDERED)
def video(
    match: int, caller: AnyReader, session: Reading, season: CurrentSeason, renders: Renders, now: Now
) -> Response:
    """Have the video of a match rendered, and return how far it is."""
    path = record_path(session, season, match, caller)
    return progress_response(renders.progress("video", str(match), path, now))


@router.get("/matches/{match}/video.mp4", responses=RENDERED)
def video_file(
    match: int, caller: AnyReader, session: Reading, season: CurrentSeason, renders: Renders, now: Now
) -> Response:
    """Return the video of a match, or the piece of it that the header Range asks for, once it is rendered."""
    path = record_path(session, season, match, caller)
    return file_response("video", renders.progress("video", str(match), path, now))


@router.get("/matches/{match}/logs/{seat}", response_class=PlainTextResponse, responses=REFUSALS)
def logs(match: int, seat: int, caller: KnownReader, session: Reading, season: CurrentSeason) -> str:
    """Return what an agent of your team printed in a match."""
    found, place = find_match(session, match), session.get(MatchSeat, (match, seat))
    visible = seen_by(session, [found], caller)[match]
    owner = None if place is None else session.get(Submission, place.submission_id or 0)
    if owner is None or not visible.is_own(session.get_one(Team, owner.team_id).name):
        raise NotFoundError(f"your team has no seat {seat} in match {match}")
    if visible.record:
        raise ForbiddenError(visible.record)
    result = session.get_one(MatchResult, match)
    row = next(one for one in result.row["seats"] if one["seat"] == seat)
    if row["log"] is None:
        return "It printed nothing.\n"
    return shown_log(season.match_folder(match) / row["log"])
