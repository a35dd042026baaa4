"""The pages of boards: who leads, how it came about, and who beat whom."""

from datetime import datetime
from typing import Any

from fastapi import APIRouter, Request
from fastapi.responses import HTMLResponse
from markupsafe import Markup
from sqlalchemy.orm import Session

from wildscav_leaderboard.access.requests import AnyBrowser, CurrentSeason, Number, Reading
from wildscav_leaderboard.api.boards import head_to_head_view, ladder_of, ranked_teams
from wildscav_leaderboard.boards.columns import columns_of
from wildscav_leaderboard.boards.documents import FEWEST_MATCHES, SuiteBoard
from wildscav_leaderboard.boards.history import team_histories
from wildscav_leaderboard.boards.kept import board_updated, earlier_editions, read_board
from wildscav_leaderboard.seasons import state as season_state
from wildscav_leaderboard.teams.service import team_of
from wildscav_leaderboard.visibility import HIDDEN, PUBLIC, audience_for, shown_until
from wildscav_leaderboard.web.charts import Scale, rank_chart
from wildscav_leaderboard.web.rendering import PageParts, page, rendered

router = APIRouter()
CHARTED = 8  # teams whose history is drawn


@router.get("/boards/{track}", response_class=HTMLResponse)
def board(
    request: Request,
    track: str,
    season: CurrentSeason,
    session: Reading,
    caller: AnyBrowser,
    audience: str = PUBLIC,
    edition: Number | None = None,
) -> HTMLResponse:
    """Show the board of a track, or that of one of its earlier editions."""
    editions = earlier_editions(session, track)
    if edition is None and track not in season.settings.tracks and editions:
        edition = editions[0]  # the track was removed
    audience = audience_for(caller, audience, edition)
    found, updated = read_board(session, track, audience), board_updated(session, track, audience)
    team = None if caller is None else team_of(session, caller.account)
    return page(
        request,
        "board.html",
        caller,
        track=track,
        mode=season.track(track).mode if found is None else found.mode,
        audience=audience,
        edition=edition,
        editions=editions,
        updated=updated,
        frozen=season_state.is_frozen(session),
        finalized=season_state.is_finalized(session),
        part=_part(request, session, track, audience, updated, None if team is None else team.name),
    )


def _part(
    request: Request, session: Session, track: str, audience: str, updated: datetime | None, own: str | None
) -> Markup | None:
    """Return the part of a board's page that changes only when the board does."""
    parts: PageParts = request.app.state.page_parts
    if updated is None:
        return None
    return parts.get(
        (track, audience, updated, own), lambda: _rendered(session, track, audience, updated, own)
    )


def _rendered(session: Session, track: str, audience: str, updated: datetime, own: str | None) -> Markup:
    found = read_board(session, track, audience)
    shown: dict[str, Any] = {"board": found, "own": own, "is_suite": isinstance(found, SuiteBoard)}
    shown["fewest"] = FEWEST_MATCHES
    if found is not None:
        teams = ranked_teams(found, CHARTED)
        until = updated if audience == HIDDEN else min(updated, shown_until(session, None) or updated)
        histories = team_histories(session, track, teams, until)
        chart = rank_chart([(teams[name], points) for name, points in histories.items()], until)
        chart_of = {"chart": chart, "charted": list(teams)}
        shown |= {"columns": columns_of(found), "scale": Scale.of(found), **chart_of}
    return Markup(rendered("board_part.html", **shown))  # noqa: S704 (it escapes)


@router.get("/boards/{track}/head-to-head", response_class=HTMLResponse)
def head_to_head(
    request: Request, track: str, season: CurrentSeason, session: Reading, caller: AnyBrowser
) -> HTMLResponse:
    """Show who beat whom on a ladder."""
    season.track(track)
    view = head_to_head_view(session, ladder_of(session, track))
    records = {(one.first, one.second): one for one in view.records}
    return page(request, "head_to_head.html", caller, track=track, view=view, records=records)
