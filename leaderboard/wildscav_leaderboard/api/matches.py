"""Routes of matches, and of what can be seen of them."""

from dataclasses import dataclass
from typing import Annotated, Any

from fastapi import APIRouter, Depends, Query, Request
from fastapi.responses import FileResponse, PlainTextResponse, Response
from pydantic import Field

from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_leaderboard.access.requests import (
    AnyReader,
    CurrentSeason,
    KnownReader,
    Now,
    Number,
    Reading,
    Renders,
)
from wildscav_leaderboard.api.submissions import shown_log
from wildscav_leaderboard.matches.models import MatchResult, MatchSeat
from wildscav_leaderboard.matches.service import MOST, find_match, list_matches
from wildscav_leaderboard.matches.visibility import record_path, seen_by
from wildscav_leaderboard.presentation.documents import REFUSALS, MatchList, MatchView
from wildscav_leaderboard.presentation.matches import match_views
from wildscav_leaderboard.seasons.refusals import ForbiddenError, NotFoundError
from wildscav_leaderboard.spectating.live import LiveMatches, key_of
from wildscav_leaderboard.spectating.render_cache import Progress
from wildscav_leaderboard.spectating.responses import KEPT, NO_STORE, file_response, progress_response
from wildscav_leaderboard.submissions.models import Submission
from wildscav_leaderboard.teams.models import Team
from wildscav_leaderboard.teams.service import find_team

router = APIRouter(tags=["matches"])
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
    limit: Annotated[int, Query(ge=1, le=MOST)] = MOST,
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
class Rendering:
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

    def progress(self, product: str) -> Progress:
        """Return how far a file is, made from the record if the caller may see it."""
        path = record_path(self.session, self.season, self.match, self.caller)
        return self.renders.progress(product, str(self.match), path, self.now)


Asked = Annotated[Rendering, Depends()]


@router.get("/matches/{match}/trails", responses=RENDERED)
def trails(asked: Asked, request: Request, after: Annotated[str, Query(max_length=40)] = "") -> Response:
    """Return where everyone was at all times, what happened, and the map's size, as one document.

    Of a match that is being played, return what came after a cursor, which is in the document before.
    """
    if asked.is_live:
        live: LiveMatches = request.app.state.live
        told = live.trails(key_of(asked.match), after)
        if told is None:
            return progress_response(Progress("waiting", "The match begins or ends in a moment …"))
        return Response(told.model_dump_json(), media_type="application/json", headers=NO_STORE)
    return file_response("trails", asked.progress("trails"))


@router.get("/matches/{match}/overview.webp", responses=RENDERED)
def overview(asked: Asked) -> Response:
    """Return the map of a match from above."""
    if not asked.is_live:
        return file_response("overview", asked.progress("overview"))
    spec = MatchSpec.model_validate(find_match(asked.session, asked.match).spec)
    return file_response(
        "overview", asked.renders.progress("overview", str(asked.match), spec.map, asked.now)
    )


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
