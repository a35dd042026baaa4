"""What can be done with boards: bring them up to date, and decide them.

A board is computed when results arrive, and stored as a document, so that showing it reads one row. Before
the freeze the public and the hidden board are equal; after it the public one stays as it is.
"""

from datetime import datetime, timedelta
from typing import Any

from sqlalchemy import func, select
from sqlalchemy.orm import Session

from wildscav_evaluator.output.results import metric_infos
from wildscav_evaluator.seats import robot_entrant
from wildscav_leaderboard.boards import ladders
from wildscav_leaderboard.boards.conditions import conditions_of
from wildscav_leaderboard.boards.documents import (
    Conditions,
    LadderBoard,
    LadderRow,
    SuiteBoard,
    digest_of,
    place_of,
)
from wildscav_leaderboard.boards.final import Final, read_final, write_final
from wildscav_leaderboard.boards.ladder_board import Enough, LadderEntrant, ladder_board
from wildscav_leaderboard.boards.models import HIDDEN, PUBLIC, SEASON, Board, BoardPoint
from wildscav_leaderboard.boards.suite_board import SuiteResults, suite_board
from wildscav_leaderboard.boards.suite_scores import SuiteScores
from wildscav_leaderboard.matches.models import FINAL, FINISHED, SUITE, VOID, Match
from wildscav_leaderboard.matches.service import last_arrival
from wildscav_leaderboard.seasons import state as season_state
from wildscav_leaderboard.seasons.folder import Season
from wildscav_leaderboard.submissions import states
from wildscav_leaderboard.submissions.models import Submission
from wildscav_leaderboard.teams.models import Team


def refresh(
    session: Session, season: Season, sandbox: str, now: datetime, scores: SuiteScores | None = None
) -> list[str]:
    """Bring the boards up to date; return the tracks whose boards changed.

    Args:
        session: A writing session.
        season: The season.
        sandbox: In which matches are played now.
        now: The time.
        scores: The results that were read before, so that only new ones are read.
    """
    # A board says that it counts whatever arrived until its time, so it is never earlier than that.
    now = max(now, last_arrival(session) or now)
    changed, final = [], read_final(session)
    for track, settings in season.settings.tracks.items():
        if settings.mode == "ladder":
            ladders.apply_matches(session, track)
        if final is not None and track not in final.conditions:
            continue  # it was added to the settings after the end
        conditions = conditions_of(season, track, sandbox) if final is None else final.conditions[track]
        enough = [settings.interval, settings.matches] if settings.mode == "ladder" else []
        mark = {**_mark(session, track, conditions), "final": final is not None, "enough": enough}
        if season_state.read_state(session, f"board:{track}") == mark:
            continue
        season_state.write_state(session, f"board:{track}", mark, now)
        board = (
            _ladder_board(session, season, track, conditions, now, final)
            if settings.mode == "ladder"
            else _suite_board(session, season, track, conditions, now, final, scores or SuiteScores())
        )
        _store(session, board, now)
        changed.append(track)
    return changed


def read_ahead(session: Session, season: Season, sandbox: str, now: datetime, scores: SuiteScores) -> None:
    """Read all results, and compute what follows, so that the first ``refresh`` is as quick as others.

    Args:
        session: A session that reads, for however long.
        season: The season.
        sandbox: In which matches are played now.
        now: The time.
        scores: What is read.
    """
    if read_final(session) is not None:
        return
    for track, settings in season.settings.tracks.items():
        if settings.mode == "suite":
            _suite_board(session, season, track, conditions_of(season, track, sandbox), now, None, scores)


def after_boards(session: Session, now: datetime) -> datetime:
    """Return the time of a result that arrives now: later than every board, which do not count it yet.

    So the results that a board counts can be told by its time, even if a clock was put back.
    """
    latest = session.scalar(select(func.max(Board.updated)))
    return now if latest is None else max(now, latest + timedelta(microseconds=1))


def _mark(session: Session, track: str, conditions: Conditions) -> dict[str, Any]:
    """Return a mark that changes whenever the board of a track may have changed."""
    by_state = select(Match.state, func.count()).where(Match.track == track).group_by(Match.state)
    matches = {state: count for state, count in session.execute(by_state)}  # noqa: C416 (rows are no pairs to mypy)
    submissions = session.execute(
        select(func.count(), func.max(Submission.since)).where(Submission.state == states.ACTIVE)
    ).one()
    teams = session.execute(select(func.count()).where(Team.disqualified.is_not(None))).scalar_one()
    return {
        "results": matches.get(FINISHED, 0),
        "void": matches.get(VOID, 0),
        "planned": sum(matches.values()),
        "submissions": [submissions[0], str(submissions[1])],
        "disqualified": teams,
        "conditions": digest_of(conditions),
    }


def _store(session: Session, board: SuiteBoard | LadderBoard, now: datetime) -> None:
    """Store a board, and the places on it that changed."""
    document = board.model_dump(mode="json")
    frozen = season_state.read_state(session, season_state.FROZEN) is not None
    for audience in (HIDDEN,) if frozen else (HIDDEN, PUBLIC):
        found = session.get(Board, (board.track, audience))
        if found is None:
            session.add(Board(track=board.track, audience=audience, updated=now, document=document))
        else:
            # Never the same time twice, so that whoever kept a board can tell that there is another one.
            found.updated = max(now, found.updated + timedelta(microseconds=1))
            found.document = document
    _add_points(session, board, now)
    session.flush()


def _add_points(session: Session, board: SuiteBoard | LadderBoard, now: datetime) -> None:
    """Add a point to the history of every submission whose place changed."""
    last = _last_points(session, board.track)
    for row in board.rows:
        if row.submission is None or row.rank is None or row.last_rank is None:
            continue
        score, low, high = place_of(board, row)
        before = last.get(row.submission)
        # Every match changes all ratings of a ladder a little, which is no change of a place.
        same_score = before is not None and (isinstance(row, LadderRow) or before.score == score)
        place = (row.rank, row.last_rank, row.matches)
        if before is not None and same_score and (before.rank, before.last_rank, before.matches) == place:
            continue
        session.add(
            BoardPoint(
                track=board.track,
                submission_id=row.submission,
                at=now,
                rank=row.rank,
                last_rank=row.last_rank,
                score=score,
                low=low,
                high=high,
                matches=row.matches,
            )
        )


def _last_points(session: Session, track: str) -> dict[int, BoardPoint]:
    last = select(func.max(BoardPoint.id)).where(BoardPoint.track == track).group_by(BoardPoint.submission_id)
    found = session.scalars(select(BoardPoint).where(BoardPoint.id.in_(last)))
    return {point.submission_id: point for point in found}


def decide(session: Session, season: Season, final: Final, now: datetime) -> None:
    """Make the boards final, for everyone; as they were before, they are kept beside them."""
    for track in season.settings.tracks:
        before = session.get(Board, (track, HIDDEN))
        if before is not None:
            kept = Board(track=track, audience=SEASON, updated=before.updated, document=before.document)
            session.merge(kept)
    write_final(session, final, now)
    season_state.write_state(session, season_state.FROZEN, None, now)
    refresh(session, season, "", now)


def _entered(session: Session, track: str) -> list[tuple[Submission, Team]]:
    """Return the submissions that take part on a track, with their teams."""
    wanted = (
        select(Submission, Team)
        .join(Team, Team.id == Submission.team_id)
        .where(Submission.state == states.ACTIVE, Team.disqualified.is_(None))
        .order_by(Submission.id)
    )
    return [(one, team) for one, team in session.execute(wanted) if track in one.tracks]


def _suite_board(
    session: Session,
    season: Season,
    track: str,
    conditions: Conditions,
    now: datetime,
    final: Final | None,
    scores: SuiteScores,
) -> SuiteBoard:
    metrics = metric_infos(track, season.suite_matches[track][0].metrics)
    played = scores.read(session, track, SUITE if final is None else FINAL, digest_of(conditions))
    planned = len(season.suite_matches[track])
    results = [
        SuiteResults(
            submission=one.id,
            name=one.name,
            version=one.version,
            team=team.name,
            team_title=team.title,
            since=one.created,
            planned=planned,
            faults=played.faults_of(one.id),
            metrics=played.metrics.get(one.id, {}),
        )
        for one, team in _entered(session, track)
        if final is None or one.id in final.field[track]
    ]
    return suite_board(track, conditions, metrics, results, now)


def _ladder_board(
    session: Session, season: Season, track: str, conditions: Conditions, now: datetime, final: Final | None
) -> LadderBoard:
    field = None if final is None else final.field.get(track)
    entrants = [
        LadderEntrant(one.entrant, one.id, one.name, one.version, team.name, team.title, one.created)
        for one, team in _entered(session, track)
        if field is None or one.id in field
    ]
    settings = season.track(track)
    entrants += [LadderEntrant(robot_entrant(robot), None, robot) for robot in settings.robots]
    played = ladders.played_on(session, track, digest_of(conditions))
    enough = Enough(settings.interval, settings.matches)
    return ladder_board(track, conditions, metric_infos(track), entrants, played, enough, now)
