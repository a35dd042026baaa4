"""How a season ends: the best play again on seeds that nobody has seen, and all becomes public at once."""

from collections.abc import Callable
from datetime import timedelta
from pathlib import Path

import pytest
from sqlalchemy import func, select
from sqlalchemy.orm import Session
from tests.evaluator.sample_agents import CRASHER
from tests.leaderboard.agents import write_agent
from tests.leaderboard.played_seasons import enter
from tests.leaderboard.results_made import made_result
from tests.leaderboard.seasons_made import NOON, make_season, submitted, team_with_member

from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_evaluator.output.results import metric_infos
from wildscav_leaderboard.boards.kept import read_board
from wildscav_leaderboard.boards.service import refresh
from wildscav_leaderboard.conductor.editions import begin_editions
from wildscav_leaderboard.conductor.plans import plan_ladders
from wildscav_leaderboard.database.connection import Database
from wildscav_leaderboard.matches.models import FINAL, LADDER, WAITING, Match
from wildscav_leaderboard.matches.service import deliver, seats_of, void
from wildscav_leaderboard.organizing import finalizing
from wildscav_leaderboard.organizing.acts import disqualify_team, rerun
from wildscav_leaderboard.seasons import state as season_state
from wildscav_leaderboard.seasons.acts import Doing
from wildscav_leaderboard.seasons.folder import SECRET_FILE, Season
from wildscav_leaderboard.seasons.models import AuditEntry
from wildscav_leaderboard.seasons.refusals import RefusalError
from wildscav_leaderboard.submissions import states
from wildscav_leaderboard.submissions.models import Submission
from wildscav_leaderboard.submissions.service import move
from wildscav_leaderboard.visibility import HIDDEN, PUBLIC, SEASON, seen_by

TEAMS = ("foxes", "owls", "hares")
CLOSED = NOON + timedelta(days=10)
LATER = CLOSED + timedelta(minutes=1)
Time = Callable[[str], float]


def season_time(entrant: str) -> float:
    """The foxes are the best while the season lasts, then the owls."""
    return {"f": 1.0, "o": 2.0, "h": 3.0}[entrant[0]]


def final_time(entrant: str) -> float:
    """The owls are the best on seeds that nobody has seen."""
    return {"f": 2.0, "o": 1.0, "h": 0.0}[entrant[0]]


def play(session: Session, match: Match, time: Time) -> None:
    """Let a match end, with a time for every entrant."""
    seats = seats_of(session, [match.id])[match.id]
    scores = [9.0 if one.submission_id is None else time(one.entrant) for one in seats]
    result = made_result(match, seats, scores)
    deliver(session, match, None, *result, metric_infos(match.track)[0], NOON)


def play_waiting(session: Session, season: Season, time: Time) -> int:
    """Play all matches that wait, and those that follow; return how many."""
    count = 0
    while True:
        plan_ladders(session, season, NOON)
        waiting = list(session.scalars(select(Match).filter_by(state=WAITING).order_by(Match.id)))
        if not waiting:
            return count
        for match in waiting:
            play(session, match, time)
        count += len(waiting)


@pytest.fixture
def season(tmp_path: Path) -> Season:
    return make_season(tmp_path / "season", "matches = 2")


@pytest.fixture
def played(database: Database, season: Season, tmp_path: Path) -> Database:
    """A season of three teams whose matches are played, with frozen boards."""
    with database.writing() as session:
        begin_editions(session, season, NOON)
        for team in TEAMS:
            team_with_member(session, team)
            enter(session, season, team, tmp_path, 0)
        play_waiting(session, season, season_time)
        refresh(session, season, NOON)
        season_state.freeze(session, NOON)
        season_state.write_state(session, season_state.NODES, {"sandbox": "process"}, NOON)
    return database


def begin(database: Database, season: Season, best: int = 2) -> None:
    with database.writing() as session:
        finalizing.begin(session, season, "anna", best, LATER, early=False)


def advance(database: Database, season: Season) -> finalizing.Ending:
    with database.writing() as session:
        return finalizing.advance(session, season, "anna", LATER)


def end(database: Database, season: Season) -> None:
    """Go through all stages of the end."""
    begin(database, season)
    assert advance(database, season).stage == finalizing.DECIDING
    with database.writing() as session:
        play_waiting(session, season, final_time)
    assert advance(database, season).stage == finalizing.DONE


def leaders(session: Session, audience: str = PUBLIC) -> list[tuple[str, int]]:
    board = read_board(session, "navigation", audience)
    assert board is not None
    return [(row.team, row.matches) for row in board.rows]


def test_a_season_that_is_open_is_not_ended_unless_it_is_asked_for(played: Database, season: Season) -> None:
    with played.writing() as session, pytest.raises(RefusalError, match="is open until 2030-06-10 12:00 UTC"):
        finalizing.begin(session, season, "anna", 2, NOON, early=False)
    with played.writing() as session:
        finalizing.begin(session, season, "anna", 2, NOON, early=True)
    with played.writing() as session, pytest.raises(RefusalError, match="the season is closed"):
        submitted(session, season, "foxes", write_agent(season.folder, "late"))


def test_the_best_of_a_suite_play_again_on_the_seeds_of_the_second_secret(
    played: Database, season: Season
) -> None:
    begin(played, season, best=2)
    assert advance(played, season) == finalizing.Ending(
        finalizing.DECIDING,
        played=0,
        planned=4,
        note="nobody plays the matches: `wildscav season serve` starts what does",
    )
    with played.reading() as session:
        finals = list(session.scalars(select(Match).filter_by(kind=FINAL).order_by(Match.id)))
        names = {one.entrant for found in seats_of(session, [m.id for m in finals]).values() for one in found}
        assert {name.split("-")[0] for name in names} == {"foxes", "owls"}
        specs = {MatchSpec.model_validate(match.spec) for match in finals}
        assert specs == set(season.final_matches["navigation"])
        assert specs.isdisjoint(season.suite_matches["navigation"])


def test_the_final_matches_alone_decide_and_everything_is_published_at_once(
    played: Database, season: Season
) -> None:
    with played.reading() as session:
        assert leaders(session) == [("foxes", 2), ("owls", 2), ("hares", 2)]
        a_match = session.scalars(select(Match).filter_by(kind=FINAL)).first()
        assert season_state.read_state(session, season_state.OPENED) is None

    end(played, season)

    with played.reading() as session:
        # The hares would win, but were not among the two best.
        assert leaders(session) == leaders(session, HIDDEN) == [("owls", 2), ("foxes", 2)]
        assert leaders(session, SEASON) == [("foxes", 2), ("owls", 2), ("hares", 2)]
        board = read_board(session, "navigation")
        assert board is not None
        assert board.conditions.commitment == season.final_seed.commitment
        opened = season_state.read_state(session, season_state.OPENED)
        assert opened is not None
        assert opened["secret"].encode() == (season.folder / SECRET_FILE).read_bytes()
        assert season_state.read_state(session, season_state.FROZEN) is None
        a_match = session.scalars(select(Match).filter_by(kind=FINAL)).first()
        assert a_match is not None
        assert seen_by(session, [a_match], None)[a_match.id].record == ""
        acts = [(one.actor, one.act) for one in session.scalars(select(AuditEntry).order_by(AuditEntry.id))]
        assert acts == [("anna", "finalize"), ("anna", "decide")]


def test_a_ladder_is_decided_by_a_final_round_of_those_who_may_be_among_the_best(
    played: Database, season: Season
) -> None:
    end(played, season)
    with played.reading() as session:
        before, after = read_board(session, "battle", SEASON), read_board(session, "battle")
        assert before is not None
        assert after is not None
        # After two matches nobody can be told apart, so all may be among the best two.
        assert after.entered == before.entered
        assert before.conditions.commitment == season.seed.commitment
        assert after.conditions.commitment == season.final_seed.commitment
        finals = list(session.scalars(select(Match).where(Match.decides, Match.kind == LADDER)))
        assert [match.number for match in finals] == list(range(len(finals)))
        assert {row.matches for row in after.rows if row.submission} <= {2, 4}
        specs = [MatchSpec.model_validate(match.spec).map for match in finals]
        season_games = session.scalars(select(Match).where(~Match.decides, Match.kind == LADDER))
        assert not {one.seed for one in specs} & {match.spec["map"]["seed"] for match in season_games}


def test_the_season_waits_for_what_was_handed_in(played: Database, season: Season, tmp_path: Path) -> None:
    with played.writing() as session:
        late = submitted(session, season, "hares", write_agent(tmp_path, "late", body=CRASHER))
    begin(played, season)
    state = advance(played, season)
    assert (state.stage, state.pending) == (finalizing.SETTLING, 1)
    with played.writing() as session:
        move(session, session.get_one(Submission, late.id), states.CANCELLED, NOON)
    assert advance(played, season).stage == finalizing.DECIDING


def test_it_may_be_begun_and_gone_on_with_any_number_of_times(played: Database, season: Season) -> None:
    for _ in range(3):
        begin(played, season)
        assert advance(played, season).planned == 4
    end(played, season)
    for _ in range(2):
        begin(played, season)
        assert advance(played, season) == finalizing.Ending(finalizing.DONE)
    with played.reading() as session:
        acts = [one.act for one in session.scalars(select(AuditEntry))]
        assert acts == ["finalize", "decide"]
        assert len(list(session.scalars(select(Match).filter_by(kind=FINAL)))) == 4


def test_matches_that_the_platform_gave_up_are_played_again_before_anything_is_decided(
    played: Database, season: Season
) -> None:
    begin(played, season)
    advance(played, season)
    with played.writing() as session:
        match = session.scalars(select(Match).filter_by(kind=FINAL)).first()
        assert match is not None
        void(match, NOON, "given up")
        number = match.group_id
    with pytest.raises(RefusalError, match=f"final matches of {number} were given up"):
        advance(played, season)
    with played.writing() as session:
        rerun(Doing(session, season, "anna", NOON), number)
        play_waiting(session, season, final_time)
    assert advance(played, season).stage == finalizing.DONE


def test_who_is_disqualified_meanwhile_is_on_no_final_board(played: Database, season: Season) -> None:
    begin(played, season)
    advance(played, season)
    with played.writing() as session:
        disqualify_team(Doing(session, season, "anna", NOON), "foxes", reason="two teams, one person")
        play_waiting(session, season, final_time)
    assert advance(played, season).stage == finalizing.DONE
    with played.reading() as session:
        assert leaders(session) == [("owls", 2)]


def test_an_end_that_waits_is_taken_back_and_may_be_begun_again(played: Database, season: Season) -> None:
    begin(played, season)
    advance(played, season)
    finals = select(func.count()).where(Match.decides, Match.state == WAITING)
    with played.writing() as session:
        planned = session.scalar(finals)
        assert planned
        finalizing.abort(session, "anna", NOON)
        assert session.scalar(finals) == 0
        assert season_state.read_state(session, season_state.FINALIZING) is None
        with pytest.raises(RefusalError, match="is not being decided"):
            finalizing.abort(session, "anna", NOON)
    begin(played, season)
    advance(played, season)
    with played.writing() as session:
        assert session.scalar(finals) == planned
    end(played, season)
    with played.writing() as session, pytest.raises(RefusalError, match="its secrets are opened"):
        finalizing.abort(session, "anna", LATER)


def test_after_the_end_a_disqualified_team_leaves_its_board_and_no_ladder_goes_on(
    played: Database, season: Season
) -> None:
    end(played, season)
    with played.writing() as session:
        disqualify_team(Doing(session, season, "anna", LATER), "owls", reason="found out later")
        refresh(session, season, LATER)
        for match in session.scalars(select(Match).filter_by(kind=LADDER)):
            void(match, LATER, "given up")
        assert plan_ladders(session, season, LATER) == 0
    with played.reading() as session:
        assert leaders(session) == [("foxes", 2)]
