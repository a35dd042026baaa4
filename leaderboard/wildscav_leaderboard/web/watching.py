"""The pages of matches: all of them, how one ended, in 3D, live, as a video, and in Rerun."""

import json
from functools import partial
from http import HTTPStatus
from typing import Annotated, Literal, NamedTuple

from fastapi import APIRouter, Query, Request
from fastapi.responses import HTMLResponse, PlainTextResponse
from sqlalchemy.orm import Session

from wildscav.errors import UserError
from wildscav_evaluator.output.results import metric_infos
from wildscav_leaderboard.access.requests import AnyBrowser, CurrentSeason, Now, Number, Reading, Renders
from wildscav_leaderboard.api.documents import MatchView, SeatView
from wildscav_leaderboard.api.match_views import match_views
from wildscav_leaderboard.api.matches import map_spec_of
from wildscav_leaderboard.matches.models import FINISHED, PLAYING, VOID, WAITING, Match
from wildscav_leaderboard.matches.service import find_match, list_matches
from wildscav_leaderboard.playing.permission import open_tracks, refused_why
from wildscav_leaderboard.seasons.folder import Season
from wildscav_leaderboard.seasons.refusals import ForbiddenError
from wildscav_leaderboard.seasons.state import NOTES_HIDDEN, read_state
from wildscav_leaderboard.spectating import rerun_viewer
from wildscav_leaderboard.submissions.service import find_submission
from wildscav_leaderboard.teams.service import find_team, titles
from wildscav_leaderboard.visibility import record_path, render_key, seen_by
from wildscav_leaderboard.web.rendering import page
from wildscav_stage.scene.document import TRAILS_VERSION
from wildscav_stage.scene.map_file import map_key
from wildscav_stage.viewer_files import viewer_addresses

router = APIRouter()
SHOWN = 25  # matches of a list
STATES = (FINISHED, PLAYING, WAITING, VOID)


@router.get("/matches", response_class=HTMLResponse)
def matches(
    request: Request,
    session: Reading,
    caller: AnyBrowser,
    track: str = "",
    team: str = "",
    state: Literal["", "finished", "playing", "waiting", "void"] = "",
    before: Number | None = None,
) -> HTMLResponse:
    """List matches: those that are being played, then those that are over, the newest first."""
    own = find_team(session, team).id if team else None
    listed = partial(list_matches, session, team=own, track=track or None, limit=SHOWN)
    live = listed(state=PLAYING) if not state and before is None else []
    found = listed(state=state or FINISHED, before=before)
    return page(
        request,
        "matches.html",
        caller,
        matches=match_views(session, [*live, *found], caller),
        live=bool(live),
        more=found[-1].id if len(found) == SHOWN else None,
        chosen={"track": track, "team": team, "state": state},
        states=STATES,
        teams=titles(session),
    )


@router.get("/matches/{number}", response_class=HTMLResponse)
def match(
    request: Request,
    number: Number,
    session: Reading,
    caller: AnyBrowser,
    season: CurrentSeason,
    renders: Renders,
    other: Annotated[Number | None, Query(alias="with")] = None,  # a match beside which it is shown
) -> HTMLResponse:
    """Show a match: its result, and how it went."""
    found = find_match(session, number)
    (view,) = match_views(session, [found], caller)
    unwatched = seen_by(session, [found], caller)[number].live
    return page(
        request,
        "match.html",
        caller,
        match=view,
        infos={info.name: info for info in metric_infos(view.track)},
        names=list(dict.fromkeys(name for seat in view.seats for name in seat.metrics or ())),
        seat_names=_seat_names(view),
        compared=_compared(session, caller, other),
        placed=any(seat.place for seat in view.seats),
        told=any(seat.status is not None for seat in view.seats),
        timed=any(seat.latency_p50 is not None for seat in view.seats),
        unseen=_unseen(view),
        visible=view.hidden is None,
        live=found.state == PLAYING and not unwatched,
        unwatched=unwatched,
        unheard=(read_state(session, NOTES_HIDDEN) or {}).get(str(number)),
        stage=_stage(found, view),
        playable=_playable(session, season, view),
        has_poster=view.hidden is None and renders.is_kept("poster", str(number)),
    )


class MatchStage(NamedTuple):
    """The addresses of what draws a match in 3D."""

    script: str
    style: str
    map: str  # this and the next are others where the files are
    trails: str
    notes: str
    live: str  # the stream of a match that is being played


def _stage(match: Match, view: MatchView) -> MatchStage | None:
    """Return what draws a match; None if the viewer is not built."""
    try:
        script, style = viewer_addresses()
    except UserError:
        return None  # the log says so since the site began
    files, record = f"/api/v1/matches/{match.id}", (view.record or "")[:16]
    trails = f"{files}/trails?v={TRAILS_VERSION}{record and '-'}{record}"
    game_map = f"{files}/map?v={map_key(map_spec_of(match))}"
    return MatchStage(script, style, game_map, trails, f"{files}/notes", f"{files}/live")


def _seat_names(view: MatchView) -> str:
    return json.dumps({seat.seat: seat.who for seat in view.seats})


class Compared(NamedTuple):
    """A match that is shown beside another."""

    match: MatchView
    stage: MatchStage | None
    seat_names: str


def _compared(session: Session, caller: AnyBrowser, number: int | None) -> Compared | None:
    """Return a match to be shown beside another."""
    if number is None:
        return None
    found = find_match(session, number)
    (view,) = match_views(session, [found], caller)
    if view.hidden is not None:
        raise ForbiddenError(view.hidden)
    return Compared(view, _stage(found, view), _seat_names(view))


def _playable(session: Session, season: Season, view: MatchView) -> list[SeatView]:
    """Return a seat of each submission of a match against which people may play on its track."""
    if view.track not in open_tracks(season):
        return []
    seats = {seat.submission: seat for seat in view.seats if seat.submission is not None}
    return [
        seat
        for number, seat in seats.items()
        if not refused_why(session, season, find_submission(session, number), view.track)
    ]


def _unseen(view: MatchView) -> str:
    """Return of which seats the results are kept from whoever looks: "all", "some", or an empty text."""
    unknown = [seat.status is None for seat in view.seats]
    if view.state != FINISHED or not any(unknown):
        return ""
    return "all" if all(unknown) else "some"


@router.get("/robots.txt")
def robots() -> PlainTextResponse:
    """Keep search engines from what is made for whoever asks for it."""
    return PlainTextResponse("User-agent: *\nDisallow: /matches/*/video\nDisallow: /matches/*/watch\n")


@router.get("/matches/{number}/video", response_class=HTMLResponse)
@router.get("/matches/{number}/watch", response_class=HTMLResponse)
def made_of_record(
    request: Request,
    number: Number,
    session: Reading,
    caller: AnyBrowser,
    season: CurrentSeason,
    renders: Renders,
    now: Now,
) -> HTMLResponse:
    """Have the video or the replay of a match made, and show it; the replay in the Rerun viewer."""
    (view,) = match_views(session, [find_match(session, number)], caller)
    if view.hidden is not None:
        raise ForbiddenError(view.hidden)
    product = "video" if request.url.path.endswith("/video") else "replay"
    source, key = record_path(session, season, number, caller), render_key(session, number, product)
    made = renders.progress(product, key, source, now)
    viewer = rerun_viewer.address_of(str(request.url_for("replay_file", match=number)))
    status = HTTPStatus.SERVICE_UNAVAILABLE if made.state == "failed" else HTTPStatus.OK
    return page(request, "made.html", caller, status, match=view, product=product, made=made, viewer=viewer)
