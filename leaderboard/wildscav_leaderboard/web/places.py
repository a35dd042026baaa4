"""Where a submission stands on each of its tracks, for its page."""

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime

from sqlalchemy.orm import Session

from wildscav_leaderboard.accounts.service import Caller
from wildscav_leaderboard.api.boards import opponent_views
from wildscav_leaderboard.api.documents import OpponentView, SubmissionView
from wildscav_leaderboard.boards.documents import ProgressView, Row
from wildscav_leaderboard.boards.history import histories_of
from wildscav_leaderboard.boards.kept import read_board
from wildscav_leaderboard.boards.models import BoardPoint
from wildscav_leaderboard.boards.progress import progress_of
from wildscav_leaderboard.matches.visibility import shown_until
from wildscav_leaderboard.seasons.folder import Season
from wildscav_leaderboard.submissions.models import Submission
from wildscav_leaderboard.submissions.states import ACTIVE
from wildscav_leaderboard.web.charts import Chart, rank_chart


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
    points, met = histories_of(session, one.id, until), opponent_views(session, tracks, one)
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
