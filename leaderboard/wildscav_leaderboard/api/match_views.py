"""Matches as people read them: their seats, what each reached, and who won."""

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

from sqlalchemy import select
from sqlalchemy.orm import Session

from wildscav_evaluator.seats import ROBOT_ENTRANT
from wildscav_leaderboard.accounts.service import Caller
from wildscav_leaderboard.api.documents import MatchView, SeatView
from wildscav_leaderboard.boards.ladders import places_of
from wildscav_leaderboard.matches.models import LADDER, Match, MatchResult, MatchSeat
from wildscav_leaderboard.matches.service import results_of
from wildscav_leaderboard.submissions.models import Submission
from wildscav_leaderboard.teams.models import Team
from wildscav_leaderboard.visibility import Visible, seen_by

OUTCOME = ("status", "fault", "metrics")  # of a seat; its detail is for its own team
ANSWERS = ("latency_p50", "latency_p99", "latency_max", "late_steps")  # how long an agent took
TIE = "no winner: a tie"
FOR_SCORE = "no winner: played for the score"  # in a suite, where one submission alone is judged


class EntrantNames(NamedTuple):
    """What people read of a submission that plays."""

    name: str  # its name and version
    team: str
    team_title: str


def titled(name: str, version: str) -> str:
    """Return a submission's name and version as people read them."""
    return f"{name} {version}"


def robot_name(entrant: str) -> str:
    """Return a robot's name as people read it."""
    return entrant.removeprefix(ROBOT_ENTRANT)


def match_views(session: Session, matches: Sequence[Match], caller: Caller | None) -> list[MatchView]:
    """Return matches with the results that a caller may see."""
    if not matches:
        return []
    seats, names = _seats(session, [match.id for match in matches])
    results = results_of(session, list(matches))
    seen = seen_by(session, matches, caller, {number: result.at for number, result in results.items()})
    return [
        _view(match, seats.get(match.id, []), results.get(match.id), names, seen[match.id])
        for match in matches
    ]


def _seats(
    session: Session, matches: Sequence[int]
) -> tuple[dict[int, list[MatchSeat]], dict[int, EntrantNames]]:
    """Return the seats of some matches, by match, and what people read of the submissions in them."""
    seats: dict[int, list[MatchSeat]] = {}
    names: dict[int, EntrantNames] = {}
    wanted = (
        select(MatchSeat, Submission.name, Submission.version, Team.name, Team.title)
        .outerjoin(Submission, Submission.id == MatchSeat.submission_id)
        .outerjoin(Team, Team.id == Submission.team_id)
        .where(MatchSeat.match_id.in_(matches))
        .order_by(MatchSeat.match_id, MatchSeat.seat)
    )
    for seat, name, version, team, title in session.execute(wanted):
        seats.setdefault(seat.match_id, []).append(seat)
        if seat.submission_id is not None:
            names[seat.submission_id] = EntrantNames(titled(name, version), team, title)
    return seats, names


def _view(
    match: Match,
    seats: Sequence[MatchSeat],
    result: MatchResult | None,
    names: Mapping[int, EntrantNames],
    visible: Visible,
) -> MatchView:
    rows, timings = _rows(result)
    views = []
    for seat in seats:
        known = None if seat.submission_id is None else names.get(seat.submission_id)
        team = None if known is None else known.team
        row = None if visible.outcome_in(team) else rows.get(seat.seat)
        detailed = visible.is_own(team) and not visible.own
        views.append(_seat(seat, known, row, timings.get(seat.seat) if detailed else None, detailed=detailed))
    views, winner = judged(match, views)
    return MatchView.about(
        match,
        winner=winner,
        since=None if visible.own else match.since,
        detail="" if visible.own else match.detail,
        seats=views,
        hidden=visible.record or None,
        unseen=visible.outcome or None,
        record=None if result is None else result.record,
    )


def judged(match: Match, seats: list[SeatView]) -> tuple[list[SeatView], str | None]:
    """Return the seats of a match with their places, as its ladder counts them, and who won it.

    Whoever cannot see how it ended in every seat is told neither: the winner is then None.
    """
    metrics = [seat.metrics for seat in seats if seat.metrics is not None]
    if not seats or len(metrics) < len(seats):
        return seats, None
    if match.kind != LADDER:
        return seats, FOR_SCORE
    places = places_of(match.track, metrics)
    placed = [seat.model_copy(update={"place": place}) for seat, place in zip(seats, places, strict=True)]
    first = [seat.who for seat in placed if seat.place == 1]
    if len(first) == len(seats):
        return placed, TIE
    return placed, first[0] if len(first) == 1 else f"{' and '.join(first)}, tied"


def _rows(result: MatchResult | None) -> tuple[dict[int, dict[str, Any]], dict[int, dict[str, Any]]]:
    """Return the results and the timings of a match's seats, as they were stored."""
    if result is None:
        return {}, {}
    rows, timings = result.row["seats"], result.timing["seats"]
    return {seat["seat"]: seat for seat in rows}, {seat["seat"]: seat for seat in timings}


def _seat(
    seat: MatchSeat,
    known: EntrantNames | None,
    row: dict[str, Any] | None,
    timing: dict[str, Any] | None,
    *,
    detailed: bool,
) -> SeatView:
    told: dict[str, Any] = {}
    if row is not None:
        told = {name: row[name] for name in (*OUTCOME, "detail") if detailed or name in OUTCOME}
    if timing is not None:
        told |= {name: timing[name] for name in ANSWERS}
    return SeatView(
        seat=seat.seat,
        entrant=seat.entrant,
        name=robot_name(seat.entrant) if known is None else known.name,
        submission=seat.submission_id,
        team=None if known is None else known.team,
        team_title=None if known is None else known.team_title,
        **told,
    )
