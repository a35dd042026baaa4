"""What the conductor decides, step by step: what is tried again, what is given up, and whose news counts."""

from collections.abc import Iterator
from pathlib import Path

import pytest
from sqlalchemy import select
from tests.leaderboard.conductor.conducted import Conducted, conducting
from tests.leaderboard.seasons_made import make_season

from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_leaderboard.conductor import attempts, steps
from wildscav_leaderboard.conductor.lease import LeaseLostError
from wildscav_leaderboard.conductor.models import Attempt
from wildscav_leaderboard.conductor.plans import plan_suites
from wildscav_leaderboard.matches.models import LADDER, Match, MatchResult, MatchSeat
from wildscav_leaderboard.organizing import acts
from wildscav_leaderboard.organizing.status import status
from wildscav_leaderboard.seasons.refusals import RefusalError
from wildscav_leaderboard.submissions.models import Submission
from wildscav_leaderboard.submissions.service import history_of, move
from wildscav_server.time_limits import Clock

MORE = """
matches = 4
waiting = 3

[deadlines]
building = 100
validating = 200
attempts = 3
"""


@pytest.fixture
def season(tmp_path: Path) -> Iterator[Conducted]:
    """A season with two teams, of which this process is the conductor."""
    with conducting(make_season(tmp_path / "season", MORE)) as conducted:
        yield conducted


def given_up_by_losses(season: Conducted) -> None:
    """Take everything that waits, and lose it with its conductor, again and again."""
    for _ in range(attempts.MAX_LOST):
        season.take()
        season.take_matches(10)
        season.take_over()
        season.expire()


def test_a_submission_goes_from_state_to_state_and_gets_the_matches_of_its_suite(season: Conducted) -> None:
    number = season.active()
    with season.database.reading() as session:
        history = history_of(session, session.get_one(Submission, number))
        assert [one.state for one in history] == ["submitted", "queued", "building", "validating", "active"]
        matches = session.scalars(select(Match).order_by(Match.id)).all()
    assert [(one.track, one.number, one.group_id, one.priority) for one in matches] == [
        ("navigation", 0, number, 0),
        ("navigation", 1, number, 1),
    ]
    again = season.submission(number)
    assert season.write(lambda session: plan_suites(session, season.season, again, season.now)) == 0


def test_each_state_has_its_own_deadline(season: Conducted) -> None:
    number = season.hand_in()
    attempt = season.taken()
    assert season.submission(number).deadline == attempt.deadline
    assert (attempt.deadline - season.now).total_seconds() == 100
    following = season.built(attempt.id)
    assert following is not None
    assert (following.deadline - season.now).total_seconds() == 200
    season.validated(following.id)
    assert season.submission(number).deadline is None


def test_work_that_is_late_is_tried_again_and_then_is_the_platforms_fault(season: Conducted) -> None:
    number = season.hand_in()
    for turn in range(3):
        assert season.take() is not None
        season.wait(99)
        assert season.expire() == 0
        season.wait(1)
        assert season.expire() == 1
        assert season.submission(number).platform_faults == turn + 1
    one = season.submission(number)
    assert (one.state, one.fault, one.charged) == ("failed", "platform", False)
    assert one.reason == "it did not end before its deadline"


def test_what_a_conductor_took_with_it_is_tried_again_and_counts_for_nobody(season: Conducted) -> None:
    number = season.hand_in()
    assert season.take() is not None
    season.take_over()
    assert season.expire() == 1
    one = season.submission(number)
    assert (one.state, one.platform_faults) == ("queued", 0)


def test_what_a_planned_stop_interrupts_waits_again_at_no_cost(season: Conducted) -> None:
    season.active()
    number = season.hand_in(team="owls")
    for _ in range(attempts.MAX_LOST):
        assert season.take() is not None
        assert len(season.take_matches(2)) == 2
        season.write(lambda session: steps.hand_back(session, season.season, season.holding, season.now))
        season.take_over()
        assert season.expire() == 0
    one = season.submission(number)
    assert (one.state, one.platform_faults) == ("queued", 0)
    assert [season.match(match).state for match in (1, 2)] == ["waiting"] * 2
    with season.database.reading() as session:
        assert status(session, season.season, season.now).faults == []


def test_what_takes_every_conductor_with_it_is_given_up_and_may_be_run_again(season: Conducted) -> None:
    number = season.hand_in()
    given_up_by_losses(season)

    one = season.submission(number)
    assert (one.state, one.fault, one.charged) == ("failed", "platform", False)
    season.act(acts.rerun, number)
    assert season.take() is not None
    season.take_over()
    season.expire()
    assert season.submission(number).state == "queued"  # one loss is no reason to give it up again


def test_matches_that_were_given_up_are_played_again_from_the_beginning(season: Conducted) -> None:
    number = season.active()
    given_up_by_losses(season)
    assert season.match(1).state == season.match(2).state == "void"
    assert season.match(1).detail == "given up after 10 attempts: its conductor ended"
    season.act(acts.rerun, number)
    assert len(season.take_matches(10)) == 2
    season.take_over()
    season.expire()
    assert season.match(1).state == season.match(2).state == "waiting"


def test_matches_that_wait_for_their_turn_are_not_lost_with_their_conductor(season: Conducted) -> None:
    season.active()
    for _ in range(attempts.MAX_LOST):
        (first, _), (second, _) = season.take_matches(2, begun=False)
        season.begin(first)
        season.take_over()
        season.expire()
    assert season.match(first.match_id or 0).state == "void"  # perhaps it is what ends the conductors
    assert season.match(second.match_id or 0).state == "waiting"


def test_the_deadline_of_a_match_follows_from_its_agents_time_limits(season: Conducted) -> None:
    season.active()
    ((attempt, match), *_others) = season.take_matches(1)

    spec = MatchSpec.model_validate(match.spec)
    assert (attempt.deadline - season.now).total_seconds() == Clock().deadline(spec)
    assert season.match(match.id).deadline == attempt.deadline


def test_a_match_whose_turn_never_came_is_no_fault(season: Conducted) -> None:
    season.active()
    ((attempt, match), *_others) = season.take_matches(1, begun=False)
    season.wait((attempt.deadline - season.now).total_seconds())
    assert season.expire() == 1
    assert (season.match(match.id).state, season.match(match.id).platform_faults) == ("waiting", 0)


def test_news_of_an_attempt_that_ended_is_old(season: Conducted) -> None:
    number = season.hand_in()
    first = season.taken()
    season.wait(100)
    season.expire()
    second = season.taken()
    assert (first.number, second.number) == (1, 2)
    assert season.built(first.id) is None
    assert not season.broke(first.id)
    assert season.submission(number).state == "building"
    assert season.built(second.id) is not None
    assert season.built(second.id) is None  # and comes once


def test_a_submission_that_was_withdrawn_meanwhile_goes_no_further(season: Conducted) -> None:
    number = season.hand_in()
    attempt = season.taken()
    season.write(lambda session: move(session, session.get_one(Submission, number), "cancelled", season.now))
    assert season.built(attempt.id) is None
    assert season.submission(number).state == "cancelled"


def test_a_rejection_names_the_agent_and_is_charged(season: Conducted) -> None:
    number = season.hand_in()
    attempt = season.taken()

    def reject() -> bool:
        told = {"reason": "it crashed", "last_lines": ["oh"], "command": "wildscav check DIR"}
        return season.write(
            lambda session: steps.rejected(session, season.holding, attempt.id, season.now, **told)  # type: ignore[arg-type]
        )

    assert reject()
    assert not reject()  # it comes once
    one = season.submission(number)
    assert (one.state, one.fault, one.charged, one.last_lines) == ("failed", "agent", True, ["oh"])


def test_the_first_result_of_a_match_stays(season: Conducted) -> None:
    season.active()
    (first, match) = season.take_matches(1)[0]
    season.wait((first.deadline - season.now).total_seconds())
    season.expire()
    assert season.match(match.id).platform_faults == 1
    ((second, _),) = [one for one in season.take_matches(2) if one[1].id == match.id]
    assert season.played(first, 5.0)  # late, and as good as any
    assert not season.played(second, 6.0)
    with season.database.reading() as session:
        result = session.get_one(MatchResult, match.id)
    assert (result.score, result.attempt_id) == (5.0, first.id)


def test_a_match_that_the_platform_breaks_is_given_up_in_the_end(season: Conducted) -> None:
    season.active()
    for _ in range(3):
        ((attempt, match), *_others) = season.take_matches(1)
        assert season.broke(attempt.id, "no memory")
    found = season.match(match.id)
    assert (found.state, found.detail) == ("void", "given up after 3 attempts: no memory")
    assert not season.played(attempt)  # a result that comes later counts for nobody


def test_what_failed_is_not_run_again_for_a_disqualified_team(season: Conducted) -> None:
    number = season.hand_in()
    given_up_by_losses(season)
    season.act(acts.disqualify_team, "foxes", reason="cheats")
    with pytest.raises(RefusalError, match="the team foxes is disqualified: cheats"):
        season.act(acts.rerun, number)


def test_a_paused_season_begins_nothing_and_loses_nothing(season: Conducted) -> None:
    season.active()
    number = season.hand_in()
    season.act(acts.pause, reason="the machine moves")
    assert season.take() is None
    assert season.take_matches(5) == []
    season.act(acts.resume)
    assert season.take() is not None
    assert len(season.take_matches(5)) == 2
    assert season.submission(number).state == "building"


def test_what_was_taken_before_a_pause_and_has_not_begun_waits_again_at_no_cost(season: Conducted) -> None:
    season.active()
    (begun, playing), (taken, match) = season.take_matches(2, begun=False)
    assert season.begin(begun)
    season.act(acts.pause, reason="the machine moves")
    assert season.begin(begun)  # another try of a match that is being played
    assert not season.begin(taken)
    assert [season.match(one.id).state for one in (playing, match)] == ["playing", "waiting"]
    assert season.match(match.id).platform_faults == 0
    with season.database.reading() as session:
        assert session.get_one(Attempt, taken.id).outcome == attempts.RETURNED


def test_a_conductor_with_an_old_epoch_can_do_nothing(season: Conducted) -> None:
    season.active()
    season.hand_in("owls")
    building = season.take()
    ((playing, _), *_others) = season.take_matches(1)
    assert building is not None
    old = season.holding
    season.take_over()
    season.holding = old
    acts = (
        season.take,
        season.expire,
        lambda: season.built(building.id),
        lambda: season.validated(building.id),
        lambda: season.broke(building.id),
        lambda: season.take_matches(1),
        lambda: season.begin(playing),
        lambda: season.played(playing),
    )
    for act in acts:
        with pytest.raises(LeaseLostError):
            act()


def test_a_ladder_makes_games_ahead_and_seats_no_team_twice(season: Conducted) -> None:
    season.active("foxes", ("battle",))
    season.active("foxes", ("battle",))
    season.active("owls", ("battle",))
    # Three are to wait, and games are of two matches.
    assert season.plan() == 4
    assert season.plan() == 0
    with season.database.reading() as session:
        assert [*session.scalars(select(Match.number).filter_by(kind=LADDER))] == [0, 1, 2, 3]
        for match in session.scalars(select(Match).filter_by(kind=LADDER)):
            seats = session.scalars(select(MatchSeat).filter_by(match_id=match.id)).all()
            entered = [one.submission_id for one in seats]
            assert len(seats) == 2
            assert entered not in ([1, 2], [2, 1])  # both are of the foxes


def test_a_ladder_goes_on_until_everyone_has_enough_matches(season: Conducted) -> None:
    number = season.active("foxes", ("battle",))
    played = 0
    for _ in range(20):
        season.plan()
        for attempt, _match in season.take_matches(10):
            played += season.played(attempt)
    assert played == 4
    with season.database.reading() as session:
        seats = session.scalars(select(MatchSeat).filter_by(submission_id=number)).all()
    assert len(seats) == 4
