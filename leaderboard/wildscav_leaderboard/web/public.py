"""The pages for everyone about the season, its teams and their submissions, and where each stands."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime
from typing import Any

from fastapi import APIRouter, Request
from fastapi.responses import HTMLResponse
from sqlalchemy.orm import Session

from wildscav_evaluator.output.results import metric_infos
from wildscav_leaderboard.access.requests import AnyBrowser, CurrentSeason, Now, Number, Reading, Renders
from wildscav_leaderboard.accounts.service import Caller
from wildscav_leaderboard.api.boards import opponent_views
from wildscav_leaderboard.api.documents import MatchView, OpponentView, SubmissionView
from wildscav_leaderboard.api.match_views import match_views
from wildscav_leaderboard.api.season import counts_view, season_view
from wildscav_leaderboard.api.submissions import submission_view, submission_views
from wildscav_leaderboard.api.teams import team_view
from wildscav_leaderboard.boards.documents import BoardDocument, ProgressView, Row
from wildscav_leaderboard.boards.history import histories_of
from wildscav_leaderboard.boards.kept import read_board
from wildscav_leaderboard.boards.models import BoardPoint
from wildscav_leaderboard.boards.progress import progress_of
from wildscav_leaderboard.matches.models import FINISHED, Match
from wildscav_leaderboard.matches.service import list_matches
from wildscav_leaderboard.organizing.team_acts import acts_on
from wildscav_leaderboard.playing.permission import tracks_of
from wildscav_leaderboard.seasons.folder import Season
from wildscav_leaderboard.spectating.render_cache import RenderCache
from wildscav_leaderboard.submissions.models import Submission
from wildscav_leaderboard.submissions.service import find_submission, list_submissions
from wildscav_leaderboard.submissions.states import ACTIVE
from wildscav_leaderboard.teams.models import Team
from wildscav_leaderboard.teams.service import find_team, team_of
from wildscav_leaderboard.visibility import (
    is_anything_shown,
    is_own,
    listed_for,
    perhaps_shown,
    shown_until,
)
from wildscav_leaderboard.web.charts import Chart, rank_chart
from wildscav_leaderboard.web.rendering import page

router = APIRouter()
LEADERS = 3  # of each track on the season's page
MATCHES = 25  # of a submission on its page


@router.get("/", response_class=HTMLResponse)
def home(
    request: Request, season: CurrentSeason, session: Reading, caller: AnyBrowser, renders: Renders, now: Now
) -> HTMLResponse:
    """Show the season: what it is, who leads, its latest match, and how to take part."""
    boards = {track: read_board(session, track) for track in season.settings.tracks}
    leaders = {
        track: [] if board is None else [row for row in board.rows if row.rank is not None][:LEADERS]
        for track, board in boards.items()
    }
    over = perhaps_shown(session)
    return page(
        request,
        "home.html",
        caller,
        about=season_view(session, season),
        counts=counts_view(session),
        boards=boards,
        leaders=leaders,
        latest=_latest(session, renders, over),
        watchable=is_anything_shown(session, over),
        now=now,
    )


def _latest(session: Session, renders: RenderCache, over: Sequence[Match]) -> tuple[MatchView, str] | None:
    """Return the newest match that everyone may watch and that has a poster, and the path of the poster."""
    newest = [match for match in over if renders.is_kept("poster", str(match.id))]
    shown = (view for view in match_views(session, newest, None) if view.hidden is None)
    return next(((view, f"/api/v1/matches/{view.id}/poster.jpg") for view in shown), None)


@router.get("/teams/{name}", response_class=HTMLResponse)
def team(
    request: Request, name: str, session: Reading, caller: AnyBrowser, season: CurrentSeason, now: Now
) -> HTMLResponse:
    """Show a team, its places and its submissions."""
    found = find_team(session, name)
    own = None if caller is None else team_of(session, caller.account)
    boards = {track: read_board(session, track) for track in season.settings.tracks}
    submissions = list_submissions(session, team=found.id, where=listed_for(session, caller))
    return page(
        request,
        "team.html",
        caller,
        team=team_view(session, found),
        own=own is not None and own.id == found.id,
        places=_team_places(session, boards, found),
        submissions=submission_views(session, submissions, caller, now),
    )


def _team_places(
    session: Session, boards: Mapping[str, BoardDocument | None], team: Team
) -> list[tuple[Any, ...]]:
    """Return a team's row on each board on which it has one, with the chart of its ranks."""
    points, frozen = histories_of(session, team), shown_until(session, None)
    found = []
    for track, board in boards.items():
        if board is None:
            continue
        until = min(board.updated, frozen or board.updated)
        own = [point for point in points.get(track, []) if point.at <= until]
        chart = rank_chart([(team.title, own)], until, bands=True)
        found += [(track, row, chart) for row in board.rows if row.team == team.name]
    return found


@router.get("/submissions/{number}", response_class=HTMLResponse)
def submission(
    request: Request,
    number: Number,
    session: Reading,
    caller: AnyBrowser,
    season: CurrentSeason,
    now: Now,
    before: Number | None = None,
) -> HTMLResponse:
    """Show a submission: its states, why it failed, its places and its matches."""
    found = find_submission(session, number)
    matches = list_matches(session, submission=number, before=before, limit=MATCHES)
    views = match_views(session, matches, caller)
    seats = [seat for view in views for seat in view.seats if seat.submission == number]
    unseen = [view for view in views if view.state == FINISHED and _own_status(view, number) is None]
    shown = submission_view(session, season, found, caller, now, with_progress=False)
    places = track_places(session, season, found, shown, caller, now)
    return page(
        request,
        "submission.html",
        caller,
        submission=shown,
        own=is_own(session, caller, found),
        matches=views,
        more=matches[-1].id if len(matches) == MATCHES else None,
        infos={
            track: {info.name: info for info in metric_infos(track)}
            for track in {match.track for match in matches}
        },
        told=any(seat.metrics for seat in seats),
        timed=any(seat.latency_p99 is not None for seat in seats),
        unseen=list(dict.fromkeys(str(view.unseen) for view in unseen)),
        unseen_count=len(unseen),
        places=places,
        playable=tracks_of(season, found.state, found.playing),
        acts=acts_on(found),
    )


def _own_status(view: MatchView, submission: int) -> str | None:
    """Return how a match ended for a submission, as far as the caller may know."""
    return next((seat.status for seat in view.seats if seat.submission == submission), None)


@dataclass(frozen=True)
class TrackPlace:
    """Where a submission stands on a track."""

    track: str
    mode: str
    points: Sequence[BoardPoint]  # its ranks over time; none if it was never ranked
    chart: Chart | None
    met: list[OpponentView]
    progress: ProgressView | None  # None if it has a rank, or does not take part
    better: Row | None  # the row of its team, if that is another submission's
    frozen: bool  # whether the boards were frozen before the present, for whoever looks


def track_places(
    session: Session,
    season: Season,
    one: Submission,
    view: SubmissionView,
    caller: Caller | None,
    now: datetime,
) -> list[TrackPlace]:
    """Return where a submission, as it is shown, stands on each track on which there is something to say."""
    tracks = [track for track in one.tracks if track in season.settings.tracks]
    until = shown_until(session, caller)
    points, met = histories_of(session, one, until), opponent_views(session, tracks, one)
    better = {track: _better(session, track, view) for track in tracks}
    new = [track for track in tracks if not points.get(track) and better[track] is None]
    progress = {each.track: each for each in (progress_of(session, season, one) if new else ())}
    ends = min(now, until or now) if one.state == ACTIVE else one.since
    found = []
    for track in tracks:
        own = points.get(track, [])
        place = TrackPlace(
            track=track,
            mode=season.settings.tracks[track].mode,
            points=own,
            chart=rank_chart([(one.name, own)], ends, bands=True),
            met=met.get(track, []),
            progress=progress.get(track),
            better=better[track],
            frozen=until is not None,
        )
        if place.points or place.met or place.progress or place.better:
            found.append(place)
    return found


def _better(session: Session, track: str, view: SubmissionView) -> Row | None:
    """Return the row of a submission's team on a board, if another one of its submissions has it."""
    board = read_board(session, track)
    rows: Sequence[Row] = () if board is None or view.id not in board.entered else board.rows
    own = (row for row in rows if row.team == view.team and row.rank is not None)
    return next((row for row in own if row.submission != view.id), None)
