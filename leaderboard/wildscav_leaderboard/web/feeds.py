"""Feeds (Atom) of announcements and of what changes on boards, and badges (SVG) to show on other sites."""

from datetime import datetime
from typing import Any
from urllib.parse import urlsplit

from fastapi import APIRouter, Request
from fastapi.responses import Response
from sqlalchemy import select
from sqlalchemy.orm import Session

from wildscav.terminal.console import counted
from wildscav_evaluator.output.results import with_interface
from wildscav_leaderboard.access.requests import CurrentSeason, Number, Reading
from wildscav_leaderboard.boards.documents import BoardDocument, Row
from wildscav_leaderboard.boards.history import latest_points
from wildscav_leaderboard.boards.kept import read_board
from wildscav_leaderboard.seasons.folder import Season
from wildscav_leaderboard.seasons.models import Announcement
from wildscav_leaderboard.submissions.service import find_submission
from wildscav_leaderboard.teams.service import find_team
from wildscav_leaderboard.visibility import shown_until
from wildscav_leaderboard.web.rendering import base_of, rendered

router = APIRouter()
ENTRIES = 50  # of a feed
FEED = {"Cache-Control": "public, max-age=60", "Vary": "Host"}  # which stands in their links
# A badge is shown by other sites, and may load nothing and run nothing there.
BADGE = {
    "Cache-Control": "public, max-age=300",
    "Content-Security-Policy": "default-src 'none'; frame-ancestors *",
    "Cross-Origin-Resource-Policy": "cross-origin",
}
LETTER, NARROW, WIDE = 6.6, "fijlrtI.,:;|'() ", "mwMW"  # pixels of a letter, at the size of badges
LONGEST = 40  # letters


@router.get("/feeds/announcements.atom")
def announcements(request: Request, season: CurrentSeason, session: Reading) -> Response:
    """Return what the organizers announced, as a feed."""
    wanted = select(Announcement).order_by(Announcement.id.desc()).limit(ENTRIES)
    entries = [
        {"id": f"announcements/{one.id}", "title": one.title, "text": one.text, "at": one.at}
        | {"link": f"/#announcement-{one.id}"}
        for one in session.scalars(wanted)
    ]
    return _feed(request, season, "announcements", f"{season.settings.title}: announcements", "/", entries)


@router.get("/feeds/{track}.atom")
def board_feed(request: Request, track: str, season: CurrentSeason, session: Reading) -> Response:
    """Return what changed on a board, as a feed."""
    season.track(track)
    entries = [
        {
            "id": f"boards/{track}/points/{point.id}",
            "title": f"{team.title}: {_ranks(point.rank, point.last_rank)}",
            "text": (
                f"With {with_interface(f'{one.name} {one.version}', one.interface)}, {point.score:,.2f}, "
                f"after {counted(point.matches, 'match')}."
            ),
            "at": point.at,
            "link": f"/submissions/{one.id}",
        }
        for point, one, team in latest_points(session, track, ENTRIES, shown_until(session, None))
    ]
    title = f"{season.settings.title}: {track}"
    return _feed(request, season, f"boards/{track}", title, f"/boards/{track}", entries)


def _feed(
    request: Request, season: Season, name: str, title: str, link: str, entries: list[dict[str, Any]]
) -> Response:
    base = base_of(request)
    updated: datetime = entries[0]["at"] if entries else season.settings.opens
    host = urlsplit(base).hostname
    text = rendered(
        "feed.xml",
        base=base,
        tag=f"tag:{host},{season.settings.opens:%Y-%m-%d}:{season.settings.name}",
        name=name,
        title=title,
        link=link,
        path=request.url.path,
        entries=entries,
        updated=updated,
    )
    return Response(text, media_type="application/atom+xml", headers=FEED)


@router.get("/badges/{track}/teams/{name}.svg")
def team_badge(track: str, name: str, season: CurrentSeason, session: Reading) -> Response:
    """Return a team's rank on a track, as a picture."""
    season.track(track)
    team = find_team(session, name)
    return _badge(session, track, lambda row: row.team == team.name)


@router.get("/badges/{track}/submissions/{number}.svg")
def submission_badge(track: str, number: Number, season: CurrentSeason, session: Reading) -> Response:
    """Return a submission's rank on a track, as a picture; it has one if it is the best of its team."""
    season.track(track)
    one = find_submission(session, number)
    return _badge(session, track, lambda row: row.submission == one.id)


def _badge(session: Session, track: str, is_it: Any) -> Response:
    board = read_board(session, track)
    found = [] if board is None else [row for row in board.rows if is_it(row)]
    value = _place(board, found[0]) if board is not None and found else "not ranked"
    left, right = _shown(track), _shown(value)
    widths = {"left_width": _width(left), "right_width": _width(right)}
    text = rendered("badge.svg", left=left, right=right, **widths)
    return Response(text, media_type="image/svg+xml", headers=BADGE)


def _place(board: BoardDocument, row: Row) -> str:
    if row.rank is None or row.last_rank is None:
        return "not ranked yet"
    ranked = sum(one.rank is not None for one in board.rows)
    return f"{_ranks(row.rank, row.last_rank)} of {ranked}"


def _ranks(best: int, worst: int) -> str:
    return f"rank {best}" if best == worst else f"rank {best}–{worst}"


def _shown(text: str) -> str:
    return text if len(text) <= LONGEST else f"{text[: LONGEST - 1]}…"


def _width(text: str) -> int:
    """Return about how wide a text is, with room on both sides."""
    letters = sum(0.6 if one in NARROW else 1.45 if one in WIDE else 1.0 for one in text)
    return round(LETTER * letters) + 14
