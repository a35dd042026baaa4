"""What can be done with boards: bring them up to date, and decide them.

A board is computed when results arrive, and stored as a document, so that showing it reads one row. Before
the freeze the public and the hidden board are equal; after it the public one stays as it is.

Computing a board may take seconds, and there is one writer at a time. So the conductor computes boards in a
session that reads (``compute``), and then stores those that nothing has changed meanwhile (``store``).
"""

from collections.abc import Iterator, Mapping, Sequence
from datetime import datetime, timedelta
from hashlib import blake2b
from typing import Any, NamedTuple

from sqlalchemy import func, select
from sqlalchemy.orm import Session

from wildscav_evaluator.output.results import MetricInfo
from wildscav_leaderboard.boards import ladders
from wildscav_leaderboard.boards.documents import Entry, LadderBoard, LadderRow, SuiteBoard, place_of
from wildscav_leaderboard.boards.ladder_board import Enough, ladder_board
from wildscav_leaderboard.boards.models import Board, BoardPoint
from wildscav_leaderboard.boards.suite_board import SuiteResults, suite_board
from wildscav_leaderboard.boards.suite_scores import SuiteScores
from wildscav_leaderboard.matches.models import FINAL, FINISHED, SUITE, VOID, Match, MatchSeat
from wildscav_leaderboard.matches.service import last_arrival
from wildscav_leaderboard.seasons import state as season_state
from wildscav_leaderboard.seasons.editions import Conditions, Edition, digest_of
from wildscav_leaderboard.seasons.folder import Season
from wildscav_leaderboard.seasons.in_force import in_force
from wildscav_leaderboard.seasons.models import EditionRow
from wildscav_leaderboard.seasons.settings import TrackSettings
from wildscav_leaderboard.submissions import states
from wildscav_leaderboard.submissions.models import Submission
from wildscav_leaderboard.submissions.service import DISQUALIFIED, taking_part
from wildscav_leaderboard.teams.models import Team
from wildscav_leaderboard.visibility import HIDDEN, PUBLIC, SEASON, audience_of, shown_until


class Final(NamedTuple):
    """What the final boards of a season are computed from. It does not change with a newer Wildscav."""

    field: Mapping[str, frozenset[int]]  # the submissions that played the final matches of each suite
    conditions: Mapping[str, Conditions]  # of each track


def _read_final(session: Session) -> Final | None:
    """Return what the final boards are computed from; None before the season is decided."""
    state = season_state.read_state(session, season_state.FINALIZED)
    if state is None:
        return None
    return Final(
        {track: frozenset(numbers) for track, numbers in state["field"].items()},
        {track: Conditions.model_validate(one) for track, one in state["conditions"].items()},
    )


def _write_final(session: Session, final: Final, now: datetime) -> None:
    """Decide the season: from now on its boards are final."""
    value = {
        "at": now.isoformat(),
        "field": {track: sorted(numbers) for track, numbers in final.field.items()},
        "conditions": {track: one.model_dump(mode="json") for track, one in final.conditions.items()},
    }
    season_state.write_state(session, season_state.FINALIZED, value, now)


class Computed(NamedTuple):
    """A board that was computed, and not stored yet."""

    mark: dict[str, Any]  # changes whenever the board may have changed
    board: SuiteBoard | LadderBoard
    document: dict[str, Any]  # the board as it is stored


def refresh(session: Session, season: Season, now: datetime, scores: SuiteScores | None = None) -> list[str]:
    """Bring the boards up to date in one session; return the tracks whose boards changed.

    Args:
        session: A writing session, which is held for as long as this computes.
        scores: The results that were read before, so that only new ones are read.
    """
    while apply_results(session, season):
        pass
    return list(dict.fromkeys(store(session, season, compute(session, season, now, scores or SuiteScores()))))


def apply_results(session: Session, season: Season) -> int:
    """Apply the next results of ladders, up to so many; return how many there were."""
    editions = in_force(session, season).editions
    tracks = [track for track, one in editions.items() if one.settings.mode == "ladder"]
    return sum(ladders.apply_matches(session, track) for track in tracks)


def compute(session: Session, season: Season, now: datetime, scores: SuiteScores) -> dict[str, Computed]:
    """Compute the boards that are out of date, by the names of their marks.

    Args:
        session: A session; one that reads may take however long it likes.
        scores: The results that were read before, so that only new ones are read.
    """
    # A board says that it counts whatever arrived until its time, so it is never earlier than that.
    now = max(now, last_arrival(session) or now)
    found = {}
    for one in _out_of_date(session, season):
        board = _board(session, one, now, scores)
        found[one.name] = Computed(one.mark, board, board.model_dump(mode="json"))
    return found


def store(session: Session, season: Season, computed: Mapping[str, Computed]) -> list[str]:
    """Store boards; return the track of each that was stored.

    A board of which something has changed since it was computed is left for the next time.

    Args:
        session: A writing session.
    """
    changed = []
    for one in _out_of_date(session, season) if computed else ():
        found = computed.get(one.name)
        if found is None or found.mark != one.mark:
            continue
        season_state.write_state(session, one.name, one.mark, found.board.updated)
        for audience in one.audiences:
            _store(session, found, audience)
        if one.edition is None:
            _add_points(session, found.board)
        changed.append(one.rules.track)
    session.flush()
    return changed


class _Rules(NamedTuple):
    """What a board is made by."""

    track: str
    settings: TrackSettings
    metrics: tuple[MetricInfo, ...]
    planned: int  # matches of a suite
    conditions: Conditions


class _OutOfDate(NamedTuple):
    """A board that does not count everything that it should."""

    name: str  # of its mark in the season's state
    mark: dict[str, Any]
    rules: _Rules
    audiences: tuple[str, ...]
    final: Final | None = None
    edition: int | None = None  # an earlier one, whose board it is


def _out_of_date(session: Session, season: Season) -> list[_OutOfDate]:
    """Return the boards whose marks have changed."""
    season = in_force(session, season)
    found = (*_current(session, season), *_earlier(session, season))
    return [one for one in found if season_state.read_state(session, one.name) != one.mark]


def _current(session: Session, season: Season) -> Iterator[_OutOfDate]:
    """Yield the boards of the editions that are in force."""
    final, frozen = _read_final(session), season_state.is_frozen(session)
    for track, edition in season.editions.items():
        if final is not None and track not in final.conditions:
            continue  # it was added to the settings after the end
        conditions = edition.conditions if final is None else final.conditions[track]
        settings = season.track(track)
        state = {"final": final is not None, "frozen": frozen, "entrants": _who_takes_part(session, track)}
        if settings.mode == "ladder":
            enough = [settings.interval, settings.matches]
            state |= {"enough": enough, "applied": ladders.version_of(session, track)}
        mark = {**_mark(session, track, conditions), **state}
        rules = _Rules(track, settings, edition.metrics, edition.matches, conditions)
        yield _OutOfDate(f"board:{track}", mark, rules, (HIDDEN,) if frozen else (HIDDEN, PUBLIC), final)


def _earlier(session: Session, season: Season) -> Iterator[_OutOfDate]:
    """Yield the boards of earlier editions, whose last matches may still end."""
    if shown_until(session, None) is not None:
        return
    counted = select(Match.edition_id, func.count()).where(Match.state == FINISHED, ~Match.decides)
    earlier = Match.edition_id.is_not(None), Match.edition_id.not_in(season.numbers.values())
    played = counted.where(*earlier).group_by(Match.edition_id)
    for number, count in session.execute(played).all():
        row = session.get_one(EditionRow, number)
        name, edition = f"board:{row.track}:{number}", Edition.model_validate(row.document)
        rules = _Rules(row.track, edition.settings, edition.metrics, edition.matches, edition.conditions)
        entrants = [(one.id, team.name, team.title) for one, team in _entered_before(session, row.id)]
        mark = {"results": count, "entrants": _digest(entrants)}
        yield _OutOfDate(name, mark, rules, (audience_of(row.id),), edition=row.id)


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
    superseded = select(func.count()).where(Match.track == track, Match.superseded.is_not(None))
    return {
        "results": matches.get(FINISHED, 0),
        "void": matches.get(VOID, 0),
        "planned": sum(matches.values()),
        "superseded": session.scalar(superseded),
        "left_out": season_state.read_state(session, season_state.LEFT_OUT),
        "conditions": digest_of(conditions),
    }


def _who_takes_part(session: Session, track: str) -> str:
    """Return a digest of the submissions that take part on a track, since when, and for which team."""
    columns = (Submission.playing, Submission.id, Submission.since, Team.name, Team.title)
    wanted = select(*columns).join(Team, Team.id == Submission.team_id).order_by(Submission.id)
    found = session.execute(wanted.where(Submission.state == states.ACTIVE, Team.disqualified.is_(None)))
    return _digest([tuple(one) for playing, *one in found if track in playing])


def _digest(entrants: Sequence[tuple[Any, ...]]) -> str:
    return blake2b(repr(entrants).encode(), digest_size=16).hexdigest()


def _store(session: Session, computed: Computed, audience: str) -> None:
    track, updated = computed.board.track, computed.board.updated
    found = session.get(Board, (track, audience))
    if found is None:
        session.add(Board(track=track, audience=audience, updated=updated, document=computed.document))
    else:
        # Never the same time twice, so that whoever kept a board can tell that there is another one.
        found.updated = max(updated, found.updated + timedelta(microseconds=1))
        found.document = computed.document


def _add_points(session: Session, board: SuiteBoard | LadderBoard) -> None:
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
                at=board.updated,
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
    for track in in_force(session, season).editions:
        before = session.get(Board, (track, HIDDEN))
        if before is not None:
            kept = Board(track=track, audience=SEASON, updated=before.updated, document=before.document)
            session.merge(kept)
    _write_final(session, final, now)
    season_state.write_state(session, season_state.FROZEN, None, now)
    refresh(session, season, now)


def entered(session: Session, track: str) -> list[tuple[Submission, Team]]:
    """Return the submissions that take part on a track, with their teams, but none that are left out."""
    left_out = season_state.read_state(session, season_state.LEFT_OUT) or {}
    found = taking_part(session, track)
    return [(one, team) for one, team in found if str(one.id) not in left_out]


def _entered_before(session: Session, edition: int) -> list[tuple[Submission, Team]]:
    """Return the submissions that have played under an edition, with their teams, but no disqualified."""
    seats = select(MatchSeat.submission_id).join(Match, Match.id == MatchSeat.match_id)
    wanted = (
        select(Submission, Team)
        .join(Team, Team.id == Submission.team_id)
        .where(
            Submission.id.in_(seats.where(Match.edition_id == edition, Match.state == FINISHED)),
            Team.disqualified.is_(None),
            Submission.reason.not_like(f"{DISQUALIFIED}%"),
        )
        .order_by(Submission.id)
    )
    return [(one, team) for one, team in session.execute(wanted)]


def _board(session: Session, one: _OutOfDate, now: datetime, scores: SuiteScores) -> SuiteBoard | LadderBoard:
    rules, final = one.rules, one.final
    own = entered(session, rules.track) if one.edition is None else _entered_before(session, one.edition)
    if final is not None and rules.track in final.field:
        own = [(each, team) for each, team in own if each.id in final.field[rules.track]]
    if rules.settings.mode == "ladder":
        return _ladder_board(session, rules, own, now)
    kind = SUITE if final is None else FINAL
    played = scores.read(session, rules.track, kind, digest_of(rules.conditions))
    results = [
        SuiteResults(
            entry=Entry.of(each, team.name, team.title),
            planned=rules.planned,
            faults=played.faults_of(each.id),
            metrics=played.metrics.get(each.id, {}),
        )
        for each, team in own
    ]
    return suite_board(rules.track, rules.conditions, rules.metrics, results, now)


def _ladder_board(
    session: Session, rules: _Rules, entered: Sequence[tuple[Submission, Team]], now: datetime
) -> LadderBoard:
    entrants = [Entry.of(one, team.name, team.title) for one, team in entered]
    entrants += Entry.of_robots(rules.settings.robots)
    played = ladders.played_on(session, rules.track, digest_of(rules.conditions))
    enough = Enough(rules.settings.interval, rules.settings.matches)
    return ladder_board(rules.track, rules.conditions, rules.metrics, entrants, played, enough, now)
