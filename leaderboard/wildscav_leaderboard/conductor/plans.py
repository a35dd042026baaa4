"""Which matches the season plans: the suites of its active submissions, and the next ones of its ladders.

At the end, the ladders get a final round: another ladder with the same rules among the field of each, on
games of the second secret. It decides alone, so luck in the season's matches is worth nothing in it.
"""

from collections.abc import Iterable, Sequence
from dataclasses import replace
from datetime import datetime
from typing import NamedTuple

from sqlalchemy import func, select
from sqlalchemy.orm import Session

from wildscav_evaluator.seats import robot_entrant
from wildscav_leaderboard.boards.ladder_board import Rating, ratings_of
from wildscav_leaderboard.boards.ladders import played_on
from wildscav_leaderboard.boards.matchmaking import REPEATS, Candidate, choose_entrants, ladder_match
from wildscav_leaderboard.matches.models import (
    FINAL_ROUND,
    LADDER,
    SEASON_ROUND,
    VOID,
    WAITING,
    Match,
    MatchSeat,
)
from wildscav_leaderboard.matches.service import Entrant, add_ladder_match, add_suite_matches
from wildscav_leaderboard.seasons.editions import digest_of
from wildscav_leaderboard.seasons.folder import Season
from wildscav_leaderboard.seasons.in_force import in_force, model_of, sandbox_of
from wildscav_leaderboard.seasons.state import FINALIZING, is_finalized, read_state
from wildscav_leaderboard.submissions.models import Submission
from wildscav_leaderboard.submissions.service import taking_part


def plan_suites(session: Session, season: Season, submission: Submission, now: datetime) -> int:
    """Plan the matches of all suites that a submission plays and has not got yet; return how many are new."""
    season = in_force(session, season)
    return sum(
        add_suite_matches(session, submission, track, season.suite_matches[track], now)
        for track in submission.playing
        if track in season.suite_matches and is_playable(session, season, track)
    )


def is_playable(session: Session, season: Season, track: str) -> bool:
    """Return whether matches of a track's edition can be made here and now, by the same code as before."""
    edition = season.editions.get(track)
    if edition is None:
        return True
    return not edition.obstacle(sandbox_of(session, season), model_of(season))


def plan_ladders(session: Session, season: Season, now: datetime) -> int:
    """Plan the next matches of all ladders, up to so many that wait; return how many are new."""
    season = in_force(session, season)
    return sum(_plan_ladder(session, season, one, now) for one in _rounds(session, season))


def ladders_want_matches(session: Session, season: Season) -> bool:
    """Return whether a ladder has submissions that have not played enough, and can meet somebody."""
    season = in_force(session, season)
    return any(_next_game(season, one, _candidates(session, season, one)) for one in _rounds(session, season))


def rate_ladders(session: Session, season: Season) -> None:
    """Rate the entrants of all ladders, so that no session that writes after this one has to."""
    season = in_force(session, season)
    for one in _rounds(session, season):
        _ratings(session, season, one)


class _Round(NamedTuple):
    """What is played on a ladder now."""

    track: str
    group: int
    field: Sequence[int] | None  # the submissions that take part in the final round


def _rounds(session: Session, season: Season) -> list[_Round]:
    """Return what is played on all ladders now; nothing once the season is decided."""
    if is_finalized(session):
        return []
    season = in_force(session, season)
    field = (read_state(session, FINALIZING) or {}).get("field")
    ladders = [
        track
        for track, settings in season.settings.tracks.items()
        if settings.mode == "ladder" and is_playable(session, season, track)
    ]
    if field is None:
        return [_Round(track, SEASON_ROUND, None) for track in ladders]
    return [_Round(track, FINAL_ROUND, field.get(track, ())) for track in ladders]


def _plan_ladder(session: Session, season: Season, one: _Round, now: datetime) -> int:
    ladder = {"track": one.track, "kind": LADDER, "group_id": one.group}
    counting = select(func.count()).select_from(Match)
    counting = counting.filter_by(**ladder, state=WAITING, edition_id=season.numbers.get(one.track))
    last = session.scalar(select(func.max(Match.number)).filter_by(**ladder))
    first = number = 0 if last is None else last + 1
    free = season.track(one.track).waiting - (session.scalar(counting) or 0)
    found = _candidates(session, season, one) if free > 0 else {}
    seed = season.seed if one.group == SEASON_ROUND else season.final_seed
    while number - first < free:
        chosen = _next_game(season, one, found, f"{one.track}/{number}")
        if chosen is None:
            break
        numbers = {each.name: found.pop(each) for each in chosen}
        for turn in range(REPEATS):
            drawn = season.suite(one.track), one.track, seed.value, number + turn, sorted(numbers)
            spec, seats = ladder_match(*drawn)
            entrants = {seat: Entrant(name, numbers[name]) for seat, name in seats.items()}
            add_ladder_match(session, one.track, number + turn, spec, entrants, now, one.group)
        found |= {replace(each, matches=each.matches + REPEATS): numbers[each.name] for each in chosen}
        number += REPEATS
    return number - first


def _next_game(
    season: Season, one: _Round, found: Iterable[Candidate], key: str = ""
) -> tuple[Candidate, ...] | None:
    settings = season.track(one.track)
    return choose_entrants(list(found), settings.seats, settings.matches, key)


def _candidates(session: Session, season: Season, one: _Round) -> dict[Candidate, int | None]:
    """Return all who may meet on a ladder, and the submission that each is."""
    settings, ratings = season.track(one.track), _ratings(session, season, one)
    counted = session.execute(
        select(MatchSeat.entrant, func.count())
        .join(Match, Match.id == MatchSeat.match_id)
        .where(Match.track == one.track, Match.kind == LADDER, Match.group_id == one.group)
        .where(Match.state != VOID, Match.edition_id == season.numbers.get(one.track), Match.judging == 1)
        .group_by(MatchSeat.entrant)
    )
    planned = {entrant: count for entrant, count in counted}  # noqa: C416 (rows are no pairs to mypy)

    def candidate(name: str, team: int | None) -> Candidate:
        rating = ratings.get(name, Rating())
        return Candidate(name, team, rating.mean, planned.get(name, 0), rating.is_settled)

    found: dict[Candidate, int | None] = {
        candidate(each.entrant, team.id): each.id
        for each, team in taking_part(session, one.track)
        if one.field is None or each.id in one.field
    }
    return found | {candidate(robot_entrant(robot), None): None for robot in settings.robots}


def _ratings(session: Session, season: Season, one: _Round) -> dict[str, Rating]:
    edition = season.editions.get(one.track)
    if edition is None:
        return {}
    conditions = edition.conditions if one.group == SEASON_ROUND else edition.final
    played = played_on(session, one.track, digest_of(conditions))
    return ratings_of(played, season.track(one.track).interval)
