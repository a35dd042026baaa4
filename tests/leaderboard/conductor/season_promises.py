"""What must be true of a season's database at any moment, and what when everything has ended."""

from collections import Counter

from sqlalchemy import func, select
from sqlalchemy.orm import Session

from wildscav_leaderboard.boards.models import LadderStep
from wildscav_leaderboard.conductor.attempts import running
from wildscav_leaderboard.conductor.models import BUILD, PLAY, VALIDATE, Attempt
from wildscav_leaderboard.matches.models import (
    FINISHED,
    LADDER,
    PLAYING,
    SUITE,
    VOID,
    WAITING,
    Match,
    MatchResult,
    MatchSeat,
)
from wildscav_leaderboard.seasons.folder import Season
from wildscav_leaderboard.submissions import states
from wildscav_leaderboard.submissions.models import Submission, Transition
from wildscav_leaderboard.submissions.queue import queue
from wildscav_leaderboard.teams.models import Team

LATE = "it did not end before its deadline"


def check_always(session: Session, season: Season) -> None:
    """Check what is true after every transaction, whatever happened before it."""
    _check_work(session)
    _check_matches(session)
    _check_suites(session, season)
    _check_charges(session, season)


def _check_work(session: Session) -> None:
    """Whatever has not ended is in the queue, or is worked on by one attempt until a deadline."""
    open_attempts = running(session)
    building = {one.submission_id: one for one in open_attempts if one.kind == BUILD}
    validating = {one.submission_id: one for one in open_attempts if one.kind == VALIDATE}
    under_way = Counter(one.submission_id for one in open_attempts)
    waiting = {one.id for one in queue(session)}
    for submission in session.scalars(select(Submission)):
        state = submission.state
        assert (submission.id in waiting) == (state in (states.SUBMITTED, states.QUEUED))
        if state in (states.BUILDING, states.VALIDATING):
            attempt = (building if state == states.BUILDING else validating)[submission.id]
            assert attempt.deadline == submission.deadline
            assert under_way[submission.id] == 1
        else:
            assert submission.deadline is None
            assert submission.state == states.CANCELLED or not under_way[submission.id]
    subjects = Counter((one.kind, one.submission_id, one.match_id) for one in open_attempts)
    playing = {one.match_id: one for one in open_attempts if one.kind == PLAY}
    for match in session.scalars(select(Match)):
        if match.state == PLAYING:
            assert playing[match.id].deadline == match.deadline
            assert subjects[PLAY, None, match.id] == 1
        else:
            assert match.deadline is None
            assert match.state != WAITING or match.id not in playing


def _check_matches(session: Session) -> None:
    """A match has a result when it is finished, and only then; a match without one says why."""
    results = set(session.scalars(select(MatchResult.match_id)))
    finished = set(session.scalars(select(Match.id).where(Match.state == FINISHED)))
    assert results == finished
    assert not session.scalar(select(func.count()).where(Match.state == VOID, Match.detail == ""))
    for track in session.scalars(select(LadderStep.track).distinct()):
        steps = set(session.scalars(select(LadderStep.match_id).where(LadderStep.track == track)))
        over = session.scalars(
            select(Match.id).where(
                Match.track == track, Match.kind == LADDER, Match.id <= max(steps), Match.state != VOID
            )
        )
        assert steps == set(over)


def _check_suites(session: Session, season: Season) -> None:
    """Whoever takes part has all matches of its suites, each once; nobody else's wait."""
    planned = session.execute(select(Match.group_id, Match.track).where(Match.kind == SUITE))
    counts = Counter((group, track) for group, track in planned)
    for submission in session.scalars(select(Submission).filter_by(state=states.ACTIVE)):
        for track in submission.tracks:
            if season.track(track).mode == "suite":
                assert counts[submission.id, track] == len(season.suite_matches[track])
    idle = (
        select(Match.id)
        .join(MatchSeat, MatchSeat.match_id == Match.id)
        .join(Submission, Submission.id == MatchSeat.submission_id)
        .where(Match.kind == SUITE, Match.state == WAITING, Submission.state != states.ACTIVE)
    )
    # A match that was being played when its submission left may wait once more, until it is given up.
    for number in session.scalars(idle):
        assert session.scalar(select(func.count()).select_from(Attempt).filter_by(match_id=number))


def _check_charges(session: Session, season: Season) -> None:
    """A submission is charged unless the platform gave it up, and a team never more than its quota."""
    ends: dict[int, list[str]] = {}
    for entry in session.scalars(select(Transition).order_by(Transition.id)):
        ends.setdefault(entry.submission_id, []).append(entry.state)
    days: Counter[tuple[int, str]] = Counter()
    for one in session.scalars(select(Submission)):
        assert ends[one.id][-1] == one.state
        if one.charged:
            assert one.fault != "platform"
            days[one.team_id, one.created.date().isoformat()] += 1
        else:
            assert states.FAILED in ends[one.id]
    assert max(days.values(), default=0) <= season.settings.quotas.per_day


def check_faults(session: Session, forgiven: dict[int, int]) -> None:
    """The counter of the platform's faults has each attempt that broke or was late, and nothing else.

    Args:
        session: A session.
        forgiven: By submission, its last attempt before the organizers ran it again.
    """
    broken: Counter[int] = Counter()
    for one in session.scalars(select(Attempt).where(Attempt.submission_id.is_not(None))):
        number = one.submission_id or 0
        broken[number] += (one.outcome == "platform" or one.detail == LATE) and one.id > forgiven.get(
            number, 0
        )
    for submission in session.scalars(select(Submission)):
        assert submission.platform_faults == broken[submission.id]


def check_quiet(session: Session, season: Season) -> None:
    """Check what is true when everything has ended: nothing is lost, and nothing is stuck."""
    teams = {team.id: team for team in session.scalars(select(Team))}
    assert not running(session)
    for submission in session.scalars(select(Submission)):
        assert submission.state in (*states.FINAL, states.ACTIVE)
        if submission.state == states.FAILED:
            assert submission.fault in ("agent", "platform")
            assert submission.reason
        assert submission.state != states.ACTIVE or teams[submission.team_id].disqualified is None
    active = set(session.scalars(select(Submission.id).filter_by(state=states.ACTIVE)))
    for match in session.scalars(select(Match)):
        assert match.state in (FINISHED, VOID)
        if match.kind == SUITE and match.group_id in active and match.state == VOID:
            assert match.detail.startswith("given up after")
    _check_ladders(session, season, active)


def _check_ladders(session: Session, season: Season, active: set[int]) -> None:
    """Everyone on a ladder has met others until its rating is settled."""
    for track, settings in season.settings.tracks.items():
        if settings.mode != "ladder":
            continue
        for submission in session.scalars(select(Submission).where(Submission.id.in_(active))):
            if track not in submission.tracks:
                continue
            counted = session.scalar(
                select(func.count())
                .select_from(MatchSeat)
                .join(Match, Match.id == MatchSeat.match_id)
                .where(
                    MatchSeat.submission_id == submission.id, Match.track == track, Match.state == FINISHED
                )
            )
            assert (counted or 0) >= settings.matches
