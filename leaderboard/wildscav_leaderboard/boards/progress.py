"""How far submissions are on their tracks, and which ladders wait for entrants."""

from collections import Counter

from sqlalchemy import func, select
from sqlalchemy.orm import Session

from wildscav_leaderboard.boards.documents import ProgressView, TotalsView
from wildscav_leaderboard.matches.models import FINISHED, SUITE, VOID, Match, MatchResult, MatchSeat
from wildscav_leaderboard.matches.service import are_in_force
from wildscav_leaderboard.seasons.folder import Season
from wildscav_leaderboard.submissions.models import Submission
from wildscav_leaderboard.submissions.states import ACTIVE
from wildscav_leaderboard.teams.models import Team


def totals_of(session: Session, submission: Submission) -> list[TotalsView]:
    """Return a submission's totals on each suite on which all of its matches are over.

    They count the matches under the rules in force. There are none before: each change of them would tell
    one match.
    """
    result = (MatchResult.score, MatchResult.fault, MatchResult.row["status"])
    wanted = (
        select(Match.track, Match.state, *result)
        .outerjoin(MatchResult, MatchResult.match_id == Match.id)
        .where(Match.kind == SUITE, Match.group_id == submission.id)
        .where(are_in_force(session), Match.superseded.is_(None))
        .order_by(Match.track, Match.number)
    )
    over = (FINISHED,) if submission.state == ACTIVE else (FINISHED, VOID)
    scores: dict[str, list[float]] = {}
    faults: dict[str, list[str]] = {}
    unfinished = set()
    for track, state, score, fault, status in session.execute(wanted):
        if state not in over:
            unfinished.add(track)
        if score is not None:
            scores.setdefault(track, []).append(score)
        if fault is not None:
            faults.setdefault(track, []).append(status)
    return [
        TotalsView(
            track=track, matches=len(each), score=sum(each) / len(each), faults=Counter(faults.get(track, ()))
        )
        for track, each in scores.items()
        if track not in unfinished
    ]


def progress_of(session: Session, season: Season, submission: Submission) -> list[ProgressView]:
    """Return how far a submission is on each of its tracks; nothing unless it takes part."""
    if submission.state != ACTIVE:
        return []
    counts = _counts(session, submission)
    tracks = {
        track: season.settings.tracks[track] for track in submission.tracks if track in season.settings.tracks
    }
    made = {track: sum(counts.get(track, {}).values()) for track in tracks}
    waits = any(settings.mode == "ladder" and not made[track] for track, settings in tracks.items())
    missing = missing_entrants(session, season) if waits else {}
    found = []
    for track, settings in tracks.items():
        planned = made[track] if settings.mode == "suite" else max(settings.matches, made[track])
        played = counts.get(track, {}).get(FINISHED, 0)
        waited_for = 0 if made[track] else missing.get(track, 0)
        found.append(ProgressView(track=track, played=played, planned=planned, missing=waited_for))
    return found


def _counts(session: Session, submission: Submission) -> dict[str, dict[str, int]]:
    """Return how many matches a submission has under the rules in force, by track and state.

    Matches that decide the season do not count, and a match that is judged again counts once.
    """
    wanted = (
        select(Match.track, Match.state, func.count(Match.id.distinct()))
        .join(MatchSeat, MatchSeat.match_id == Match.id)
        .where(MatchSeat.submission_id == submission.id, ~Match.decides, Match.state != VOID)
        .where(are_in_force(session), Match.judging == 1)
        .group_by(Match.track, Match.state)
    )
    found: dict[str, dict[str, int]] = {}
    for track, state, count in session.execute(wanted):
        found.setdefault(track, {})[state] = count
    return found


def missing_entrants(session: Session, season: Season) -> dict[str, int]:
    """Return how many more entrants each ladder needs before it can make a match, if it needs any.

    Submissions of one team never meet, so a team is one entrant here.
    """
    active = session.execute(
        select(Submission.team_id, Submission.playing)
        .join(Team, Team.id == Submission.team_id)
        .where(Submission.state == ACTIVE, Team.disqualified.is_(None))
    ).all()
    found = {}
    for track, settings in season.settings.tracks.items():
        teams = {team for team, tracks in active if track in tracks}
        missing = settings.seats - len(teams) - len(set(settings.robots))
        if settings.mode == "ladder" and missing > 0:
            found[track] = missing
    return found
