"""Which matches the season plans: the suites of its active submissions, and the next ones of its ladders."""

from datetime import datetime

from sqlalchemy import func, select
from sqlalchemy.orm import Session

from wildscav_evaluator.ratings.ladder import Skill
from wildscav_evaluator.seats import robot_entrant
from wildscav_leaderboard.boards.ladders import skills_of
from wildscav_leaderboard.boards.matchmaking import REPEATS, Candidate, choose_entrants, ladder_match
from wildscav_leaderboard.matches.models import LADDER, VOID, WAITING, Match, MatchSeat
from wildscav_leaderboard.matches.service import Entrant, add_ladder_match, add_suite_matches
from wildscav_leaderboard.seasons.folder import Season
from wildscav_leaderboard.seasons.in_force import in_force, sandbox_of
from wildscav_leaderboard.seasons.state import is_decided
from wildscav_leaderboard.submissions.models import Submission
from wildscav_leaderboard.submissions.states import ACTIVE
from wildscav_leaderboard.teams.models import Team


def plan_suites(session: Session, season: Season, submission: Submission, now: datetime) -> int:
    """Plan the matches of all suites that a submission plays and has not got yet; return how many are new."""
    season = in_force(session, season)
    return sum(
        add_suite_matches(session, submission, track, season.suite_matches[track], now)
        for track in submission.tracks
        if track in season.suite_matches and is_playable(session, season, track)
    )


def is_playable(session: Session, season: Season, track: str) -> bool:
    """Return whether matches of a track's edition can be made here and now, by the same code as before."""
    edition = season.editions.get(track)
    return edition is None or not edition.obstacle(sandbox_of(session, season))


def plan_ladders(session: Session, season: Season, now: datetime) -> int:
    """Plan the next matches of all ladders, up to so many that wait; return how many are new."""
    if is_decided(session):
        return 0
    season = in_force(session, season)
    return sum(
        _plan_ladder(session, season, track, now)
        for track, settings in season.settings.tracks.items()
        if settings.mode == "ladder" and is_playable(session, season, track)
    )


def ladders_want_matches(session: Session, season: Season) -> bool:
    """Return whether a ladder has submissions that have not played enough, and can meet somebody."""
    season = in_force(session, season)
    for track, settings in season.settings.tracks.items():
        if settings.mode == "ladder":
            found = list(_candidates(session, season, track))
            if choose_entrants(found, settings.seats, settings.matches, track) is not None:
                return True
    return False


def _plan_ladder(session: Session, season: Season, track: str, now: datetime) -> int:
    settings, new = season.track(track), 0
    edition = season.numbers.get(track)
    waiting = session.scalar(
        select(func.count())
        .select_from(Match)
        .filter_by(track=track, kind=LADDER, state=WAITING, edition_id=edition)
    )
    while (waiting or 0) + new < settings.waiting:
        found = _candidates(session, season, track)
        number = next_number(session, track)
        chosen = choose_entrants(list(found), settings.seats, settings.matches, f"{track}/{number}")
        if chosen is None:
            break
        names = sorted(one.name for one in chosen)
        for turn in range(REPEATS):
            spec, seats = ladder_match(season.suite(track), track, season.seed.value, number + turn, names)
            numbers = {one.name: submission for one, submission in found.items()}
            entrants = {seat: Entrant(name, numbers[name]) for seat, name in seats.items()}
            add_ladder_match(session, track, number + turn, spec, entrants, now)
        new += REPEATS
    return new


def next_number(session: Session, track: str) -> int:
    """Return the number of the next match on a track's ladder."""
    last = session.scalar(select(func.max(Match.number)).filter_by(track=track, kind=LADDER))
    return 0 if last is None else last + 1


def _candidates(session: Session, season: Season, track: str) -> dict[Candidate, int | None]:
    """Return all who may meet on a ladder, and the submission that each is."""
    skills = skills_of(session, track)
    counted = session.execute(
        select(MatchSeat.entrant, func.count())
        .join(Match, Match.id == MatchSeat.match_id)
        .where(
            Match.track == track,
            Match.kind == LADDER,
            Match.state != VOID,
            Match.edition_id == season.numbers.get(track),
            Match.judging == 1,
        )
        .group_by(MatchSeat.entrant)
    )
    planned = {entrant: count for entrant, count in counted}  # noqa: C416 (rows are no pairs to mypy)
    active = session.execute(
        select(Submission, Team)
        .join(Team, Team.id == Submission.team_id)
        .where(Submission.state == ACTIVE, Team.disqualified.is_(None))
    )

    def candidate(name: str, team: int | None) -> Candidate:
        return Candidate(name, team, skills.get(name, Skill()).mu, planned.get(name, 0))

    found: dict[Candidate, int | None] = {
        candidate(one.entrant, team.id): one.id for one, team in active if track in one.tracks
    }
    robots = (robot_entrant(robot) for robot in season.track(track).robots)
    return found | {candidate(name, None): None for name in robots}
