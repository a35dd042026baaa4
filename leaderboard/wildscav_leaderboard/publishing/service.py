"""What is published of a season for audits: as much as its public boards count, and nothing more.

While the public boards are frozen, nothing is published that arrived later. Of a hidden match of a suite, the
digest of its record is published, and nothing else. What agents print, and what broke in their processes, is
never published.
"""

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, Literal, NamedTuple

from sqlalchemy import Select, or_, select
from sqlalchemy.orm import Session, defer

from wildscav_engine.storage.files import read_limited
from wildscav_evaluator.suites.seeds import LARGEST, SuiteSeed
from wildscav_evaluator.suites.suite import match_count
from wildscav_leaderboard.boards.documents import BoardDocument, LadderBoard
from wildscav_leaderboard.boards.kept import read_board
from wildscav_leaderboard.boards.models import Board
from wildscav_leaderboard.matches.models import (
    FINAL,
    FINAL_ROUND,
    LADDER,
    SEASON_ROUND,
    SUITE,
    VOID,
    Match,
    MatchResult,
)
from wildscav_leaderboard.matches.service import Seat, seats_of
from wildscav_leaderboard.publishing.documents import (
    End,
    Line,
    PublishedBoard,
    PublishedEdition,
    PublishedMatch,
    PublishedSeason,
    PublishedSeat,
    PublishedSecret,
    PublishedSubmission,
    PublishedTrack,
)
from wildscav_leaderboard.seasons import state as season_state
from wildscav_leaderboard.seasons.editions import Edition, digest_of, sha256_of
from wildscav_leaderboard.seasons.folder import FINAL_SECRET_FILE, SECRET_FILE, Season
from wildscav_leaderboard.seasons.models import EditionRow
from wildscav_leaderboard.submissions.models import Submission
from wildscav_leaderboard.teams.models import Team
from wildscav_leaderboard.visibility import PUBLIC, Visible, seen_by, shown_until

Audience = Literal["public", "season"]
AUDIENCES: tuple[Audience, ...] = ("public", "season")
AT_ONCE = 500  # matches that are read at once


class Addresses(NamedTuple):
    """Where the documents are, relative to the season's; {track} stands for a track's name."""

    lines: Mapping[str, str]  # the file of a board, by audience
    shown: Mapping[str, str]  # the board as it is shown, by audience
    records: str


def published_season(session: Session, season: Season, addresses: Addresses) -> PublishedSeason:
    """Return a season's document."""
    settings = season.settings
    opened = season_state.read_state(session, season_state.OPENED) is not None
    return PublishedSeason.about(
        settings,
        frozen=shown_until(session, None),
        finalized=season_state.is_finalized(session),
        secret=_secret(season.folder / SECRET_FILE, season.seed, opened=opened),
        final_secret=_secret(season.folder / FINAL_SECRET_FILE, season.final_seed, opened=opened),
        tracks=tuple(_published_track(season, track, opened=opened) for track in settings.tracks),
        editions=tuple(_editions(session, season)),
        left_out=season_state.read_state(session, season_state.LEFT_OUT) or {},
        boards=tuple(_boards(session, season, addresses)),
        records=addresses.records,
    )


def _editions(session: Session, season: Season) -> Iterator[PublishedEdition]:
    for row in session.scalars(select(EditionRow).order_by(EditionRow.id)):
        yield PublishedEdition.about(
            row,
            number=row.id,
            begun=row.created,
            in_force=row.id in season.numbers.values(),
            conditions=Edition.model_validate(row.document).conditions,
        )


def _boards(session: Session, season: Season, addresses: Addresses) -> Iterator[PublishedBoard]:
    for track in season.settings.tracks:
        for audience in AUDIENCES:
            if audience == PUBLIC or session.get(Board, (track, audience)) is not None:
                lines, shown = addresses.lines[audience], addresses.shown[audience]
                yield PublishedBoard(
                    track=track,
                    audience=audience,
                    lines=lines.replace("{track}", track),
                    shown=shown.replace("{track}", track),
                )


def _secret(path: Path, seed: SuiteSeed, *, opened: bool) -> PublishedSecret:
    secret = read_limited(path, LARGEST).hex() if opened else None
    return PublishedSecret(commitment=str(seed.commitment), secret=secret)


def _published_track(season: Season, track: str, *, opened: bool) -> PublishedTrack:
    settings, suite = season.track(track), season.suite(track)
    is_ladder = settings.mode == "ladder"
    return PublishedTrack(
        name=track,
        mode=settings.mode,
        suite=suite.label,
        suite_digest=sha256_of(suite.source),
        suite_file=suite.source.decode() if opened and suite.source is not None else None,
        rounds=settings.rounds,
        planned=settings.matches if is_ladder else match_count(suite, track, settings.rounds),
        robots=settings.robots if is_ladder else (),
        interval=settings.interval if is_ladder else None,
    )


def board_lines(
    session: Session, season: Season, track: str, audience: Audience = "public"
) -> Iterator[Line]:
    """Yield the lines of a board's file, all of one moment.

    Args:
        audience: Which of its boards: as it is, or as it was before final matches decided the season.
    """
    board = read_board(session, track, audience)
    if board is None:
        yield Line(end=End(submissions=0, matches=0))
        return
    yield Line(board=board)
    submissions = _submissions(session, board)
    yield from (Line(submission=one) for one in submissions)
    count = 0
    for match in _matches(session, season, board):
        count += 1
        yield Line.model_construct(match=match)
    yield Line(end=End(submissions=len(submissions), matches=count))


def _submissions(session: Session, board: BoardDocument) -> list[PublishedSubmission]:
    """Return the submissions that take part in a board."""
    titles = {row.team: row.team_title for row in board.rows}
    wanted = (
        select(Submission, Team)
        .join(Team, Team.id == Submission.team_id)
        .where(Submission.id.in_(board.entered))
        .order_by(Submission.id)
    )
    return [
        PublishedSubmission.about(one, team=team.name, team_title=titles.get(team.name, team.title))
        for one, team in session.execute(wanted)
    ]


def _matches(session: Session, season: Season, board: BoardDocument) -> Iterator[PublishedMatch]:
    """Yield the matches that count on a board, in the order in which they were made."""
    final = board.conditions.commitment == season.final_seed.commitment
    wanted = (
        _of_ladder(session, board, FINAL_ROUND if final else SEASON_ROUND)
        if isinstance(board, LadderBoard)
        else _of_suite(board, FINAL if final else SUITE)
    )
    if wanted is None:
        return
    # The largest columns are not needed, and reading them would take most of the time.
    wanted = wanted.options(defer(Match.spec, raiseload=True), defer(MatchResult.timing, raiseload=True))
    last = 0
    while found := session.execute(wanted.where(Match.id > last).limit(AT_ONCE)).all():
        last = found[-1][0].id
        matches = [match for match, _ in found]
        seats, visible = seats_of(session, [match.id for match in matches]), seen_by(session, matches, None)
        for match, result in found:
            one = _published(match, result, seats.get(match.id, ()), visible[match.id])
            superseded = match.superseded is not None and match.superseded <= board.updated
            if match.judging > 1 or superseded:
                one = one.model_copy(update={"judging": match.judging, "superseded": superseded})
            yield one
        session.expunge_all()


def _of_suite(board: BoardDocument, kind: str) -> "Select[Match, MatchResult]":
    """Return how to find the matches of the submissions that take part, up to the board's time."""
    return (
        select(Match, MatchResult)
        .join(MatchResult, MatchResult.match_id == Match.id)
        .where(
            Match.track == board.track,
            Match.kind == kind,
            Match.group_id.in_(board.entered),
            MatchResult.conditions == digest_of(board.conditions),
            MatchResult.at <= board.updated,
        )
        .order_by(Match.id)
    )


def _of_ladder(session: Session, board: LadderBoard, group: int) -> "Select[Match, MatchResult] | None":
    """Return how to find the matches of a ladder up to the last one that the board counts."""
    counts = or_(Match.superseded.is_(None), Match.superseded > board.updated)
    applied = (
        select(Match.id)
        .join(MatchResult, MatchResult.match_id == Match.id)
        .where(
            Match.track == board.track,
            Match.kind == LADDER,
            Match.group_id == group,
            MatchResult.conditions == digest_of(board.conditions),
            MatchResult.at <= board.updated,
            counts,
        )
        .order_by(Match.id)
    )
    last = session.scalar(applied.offset(board.applied - 1).limit(1)) if board.applied else None
    if last is None:
        return None
    later = (Match.judging > 1) & (MatchResult.at <= board.updated)  # of matches that come before
    return (
        select(Match, MatchResult)
        .outerjoin(MatchResult, MatchResult.match_id == Match.id)
        .where(Match.track == board.track, Match.kind == LADDER, Match.group_id == group)
        .where(or_(Match.id <= last, later))
        .order_by(Match.id)
    )


def _published(
    match: Match, result: MatchResult | None, seats: Sequence[Seat], visible: Visible
) -> PublishedMatch:
    known: dict[str, Any] = {"id": match.id, "kind": match.kind, "number": match.number}
    known["submission"] = None if match.kind == LADDER else match.group_id
    if result is None:
        return PublishedMatch(**known, void=match.detail or "given up" if match.state == VOID else "not over")
    if visible.outcome:  # the digest of its record binds the season to the result
        return PublishedMatch(**known, record=result.record, hidden=visible.outcome)
    # Not validated again, which would take most of the time: the season wrote it itself.
    rows = {one["seat"]: one for one in result.row["seats"]}
    return PublishedMatch.model_construct(
        **known,
        void=None,
        at=result.at,
        conditions=result.conditions,
        metrics=result.row["metrics"],
        seats=tuple(_seat(one, rows[one.seat]) for one in seats if one.seat in rows),
        record=result.record,
        record_size=result.record_size,
        hidden=visible.record or None,
    )


def _seat(one: Seat, row: Mapping[str, Any]) -> PublishedSeat:
    return PublishedSeat.model_construct(
        seat=one.seat,
        entrant=one.entrant,
        submission=one.submission_id,
        status=row["status"],
        fault=row["fault"],
        metrics=row["metrics"],
    )
