"""The ladders of the season in the database: the skills of their entrants, applied match by match.

Matches that were played under different conditions are not compared: after an upgrade of the engine, say, a
track's ladder begins anew.
"""

from collections.abc import Sequence
from dataclasses import dataclass

from sqlalchemy import Select, case, delete, func, select
from sqlalchemy.orm import Session

from wildscav_evaluator.output.results import MatchRow, metric_infos
from wildscav_evaluator.ratings.ladder import Ladder, Skill
from wildscav_evaluator.ratings.matches import RatedMatch
from wildscav_evaluator.tournaments.rated_matches import placing_metric
from wildscav_leaderboard.boards.models import LadderStep
from wildscav_leaderboard.matches.models import FINISHED, LADDER, VOID, Match, MatchResult


@dataclass(frozen=True)
class Standing:
    """What an entrant did on a ladder."""

    places: tuple[int, ...] = ()  # in the matches that were applied, in their order
    wins: int = 0  # matches in which it was first, alone
    faults: int = 0  # matches in which something went wrong in its seat


def skills_of(session: Session, track: str, conditions: str | None = None) -> dict[str, Skill]:
    """Return the current skill of every entrant that was rated on a track, by name.

    Args:
        session: A session.
        track: The track.
        conditions: Digest of the conditions of the ladder; None for whatever the entrant played last.
    """
    steps = select(LadderStep.entrant, func.max(LadderStep.match_id).label("match_id")).where(
        LadderStep.track == track
    )
    if conditions is not None:
        steps = steps.where(LadderStep.conditions == conditions)
    last = steps.group_by(LadderStep.entrant).subquery()
    wanted = select(LadderStep).join(
        last, (LadderStep.entrant == last.c.entrant) & (LadderStep.match_id == last.c.match_id)
    )
    return {step.entrant: Skill(step.mu, step.sigma) for step in session.scalars(wanted)}


def apply_matches(session: Session, track: str) -> int:
    """Apply the matches that are over, in the order in which they were made; return how many are new.

    It stops at the first match that is not over, so that no later one is ever applied before it. Where a
    result took the place of an earlier one, all matches of the track are applied again.
    """
    if session.scalar(_superseded_steps(track).limit(1)) is not None:
        session.execute(delete(LadderStep).where(LadderStep.track == track))
    done = session.scalar(select(func.max(LadderStep.match_id)).where(LadderStep.track == track)) or 0
    over = _matches_over(session, track, done)
    results = {
        result.match_id: result
        for result in session.scalars(select(MatchResult).where(MatchResult.match_id.in_(over)))
    }
    running: dict[str, Ladder] = {}
    for number in over:
        conditions = results[number].conditions
        if conditions not in running:
            running[conditions] = Ladder(skills_of(session, track, conditions))
        _apply(session, number, track, results[number], running[conditions])
    session.flush()
    return len(over)


def _superseded_steps(track: str) -> Select[int]:
    """Select the steps of a ladder whose results are superseded."""
    wanted = select(LadderStep.match_id).join(Match, Match.id == LadderStep.match_id)
    return wanted.where(LadderStep.track == track, Match.superseded.is_not(None))


def _apply(session: Session, number: int, track: str, result: MatchResult, running: Ladder) -> None:
    row = MatchRow.model_validate(result.row)
    values = [(str(seat.submission), seat.metrics) for seat in row.seats]
    rated, skills = rated_match(number, track, values), running.skills
    running.apply(rated)
    for seat, place in zip(row.seats, rated.places, strict=True):
        skill = skills[str(seat.submission)]
        session.add(
            LadderStep(
                match_id=number,
                entrant=str(seat.submission),
                track=track,
                conditions=result.conditions,
                mu=skill.mu,
                sigma=skill.sigma,
                place=place,
                fault=seat.fault is not None,
            )
        )


def _matches_over(session: Session, track: str, after: int) -> list[int]:
    """Return the matches with a result that come before the first one that is not over."""
    wanted = select(Match.id, Match.state).where(
        Match.track == track, Match.kind == LADDER, Match.id > after, Match.superseded.is_(None)
    )
    found = []
    for number, state in session.execute(wanted.order_by(Match.id)):
        if state not in (FINISHED, VOID):
            break
        if state == FINISHED:
            found.append(number)
    return found


def rated_match(number: int, track: str, seats: Sequence[tuple[str, dict[str, float]]]) -> RatedMatch:
    """Return the places of a match of a ladder, in which every entrant plays for itself.

    Args:
        number: Of the match.
        track: The track.
        seats: The entrant of each seat, and its metrics.
    """
    metric = placing_metric(metric_infos(track))
    sign = 1.0 if metric.lower_is_better else -1.0
    values = [sign * metrics[metric.name] for _, metrics in seats]
    return RatedMatch(
        game=number,
        teams=tuple((entrant,) for entrant, _ in seats),
        places=tuple(1 + sum(other < value for other in values) for value in values),
    )


def standings_of(session: Session, track: str, conditions: str) -> dict[str, Standing]:
    """Return what every entrant did in the matches that were applied, by name."""
    places: dict[str, list[int]] = {}
    faults: dict[str, int] = {}
    wanted = select(LadderStep.entrant, LadderStep.place, LadderStep.fault).where(
        LadderStep.track == track, LadderStep.conditions == conditions
    )
    for entrant, place, fault in session.execute(wanted.order_by(LadderStep.match_id)):
        places.setdefault(entrant, []).append(place)
        faults[entrant] = faults.get(entrant, 0) + fault
    wins = _wins(session, track, conditions)
    return {name: Standing(tuple(own), wins.get(name, 0), faults[name]) for name, own in places.items()}


def _wins(session: Session, track: str, conditions: str) -> dict[str, int]:
    """Return how many matches each entrant won alone."""
    firsts = func.sum(case((LadderStep.place == 1, 1), else_=0))
    alone = (
        select(LadderStep.match_id)
        .where(LadderStep.track == track, LadderStep.conditions == conditions)
        .group_by(LadderStep.match_id)
        .having(firsts == 1)
        .subquery()
    )
    counted = (
        select(LadderStep.entrant, func.count())
        .join(alone, alone.c.match_id == LadderStep.match_id)
        .where(LadderStep.place == 1)
        .group_by(LadderStep.entrant)
    )
    return {entrant: count for entrant, count in session.execute(counted)}  # noqa: C416 (rows are no pairs to mypy)


def applied_matches(session: Session, track: str, conditions: str) -> int:
    """Return how many matches were applied on a track."""
    wanted = select(func.count(LadderStep.match_id.distinct()))
    return session.scalar(wanted.where(LadderStep.track == track, LadderStep.conditions == conditions)) or 0
