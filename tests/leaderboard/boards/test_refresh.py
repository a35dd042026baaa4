"""Boards that are brought up to date bit by bit, and how far submissions are on their tracks."""

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from functools import partial
from pathlib import Path

import pytest
from sqlalchemy import func, select
from sqlalchemy.orm import Session
from tests.leaderboard.conductor.conducted import Conducted, conducting
from tests.leaderboard.results_made import made_result
from tests.leaderboard.seasons_made import changed, make_season

from wildscav_evaluator.executors.local import LocalExecutor
from wildscav_evaluator.ratings.fit import Fit, fit
from wildscav_evaluator.ratings.matches import RatedMatch
from wildscav_leaderboard.boards.documents import LadderRow, TotalsView
from wildscav_leaderboard.boards.kept import read_board
from wildscav_leaderboard.boards.progress import missing_entrants, progress_of, totals_of
from wildscav_leaderboard.boards.service import compute, refresh
from wildscav_leaderboard.boards.suite_scores import SuiteScores
from wildscav_leaderboard.conductor import steps
from wildscav_leaderboard.conductor.conductor import Conductor
from wildscav_leaderboard.conductor.editions import apply_editions
from wildscav_leaderboard.conductor.models import Attempt
from wildscav_leaderboard.conductor.plans import rate_ladders
from wildscav_leaderboard.matches.models import FINISHED, Match
from wildscav_leaderboard.matches.service import find_match, seats_of
from wildscav_leaderboard.organizing import acts
from wildscav_leaderboard.seasons import state as season_state
from wildscav_leaderboard.seasons.folder import Season
from wildscav_leaderboard.teams.service import find_team
from wildscav_leaderboard.visibility import audience_of


class CutOffError(Exception):
    """The transaction ended in the middle."""


@pytest.fixture
def season(tmp_path: Path) -> Iterator[Conducted]:
    with conducting(make_season(tmp_path / "season")) as conducted:
        conducted.active("foxes")
        conducted.active("owls")
        yield conducted


def deliver(session: Session, season: Conducted, attempt: Attempt, score: float) -> None:
    match = find_match(session, attempt.match_id or 0)
    result = made_result(match, seats_of(session, [match.id])[match.id], [score])
    assert steps.played(session, season.holding, attempt.id, *result, season.now)


def boards_agree(season: Conducted, scores: SuiteScores) -> None:
    """Compare the board that ``scores`` leads to with the one that follows from all results."""

    def board(session: Session, known: SuiteScores) -> object:
        season_state.write_state(session, "board:navigation", None, season.now)
        session.flush()
        refresh(session, season.season, season.now, known)
        return read_board(session, "navigation")

    with season.database.writing() as session:
        found = board(session, scores)
        assert found == board(session, SuiteScores())
        assert found is not None


def test_results_that_arrive_one_by_one(season: Conducted) -> None:
    scores = SuiteScores()
    for place, (attempt, _) in enumerate(season.take_matches(4)):
        season.wait(1)
        season.write(lambda session, one=attempt, at=place: deliver(session, season, one, 10.0 + at))  # type: ignore[misc]
        boards_agree(season, scores)
    board = season.board("navigation")
    assert [(row.team, row.matches) for row in board.rows] == [("foxes", 2), ("owls", 2)]


def test_results_that_arrive_after_a_clock_was_set_back(season: Conducted) -> None:
    scores = SuiteScores()
    first, second, *_ = (attempt for attempt, _ in season.take_matches(4))
    season.write(lambda session: deliver(session, season, first, 10.0))
    with season.database.reading() as session:
        compute(session, season.season, season.now, scores)
    season.wait(-3600)
    season.write(lambda session: deliver(session, season, second, 11.0))
    boards_agree(season, scores)


def test_results_that_were_seen_and_never_stored(season: Conducted) -> None:
    scores = SuiteScores()
    first, second, *_ = (attempt for attempt, _ in season.take_matches(4))
    season.write(lambda session: deliver(session, season, first, 10.0))

    def cut_off(session: Session) -> None:
        deliver(session, season, second, 99.0)
        refresh(session, season.season, season.now, scores)
        raise CutOffError

    with pytest.raises(CutOffError):
        season.write(cut_off)
    boards_agree(season, scores)
    season.write(lambda session: deliver(session, season, second, 11.0))
    boards_agree(season, scores)


def test_a_board_is_left_alone_while_nothing_changes(season: Conducted) -> None:
    ((attempt, _), *_others) = season.take_matches(1)
    season.write(lambda session: deliver(session, season, attempt, 10.0))
    assert season.refresh() == ["navigation", "battle"]
    assert season.refresh() == []


def test_a_board_follows_whose_a_submission_is(season: Conducted) -> None:
    season.refresh()

    def rename(session: Session) -> None:
        find_team(session, "foxes").title = "The new foxes"

    season.write(rename)
    assert season.refresh() == ["navigation"]


def play_ladder(season: Conducted) -> list[Attempt]:
    """Let two submissions meet on the ladder; return the last attempt, which brings no result, in a list."""
    for team in ("foxes", "owls"):
        season.active(team, ("battle",))
    season.plan()
    attempts = [attempt for attempt, match in season.take_matches(20) if match.track == "battle"]
    for attempt in attempts[:-1]:
        assert season.played(attempt)
    return attempts[-1:]


@contextmanager
def refreshing(season: Conducted) -> Iterator[Callable[..., None]]:
    """Give what a conductor does to bring its boards up to date."""
    conductor = Conductor(season.season, season.database)
    conductor._holding = season.holding
    with LocalExecutor(1) as executor:
        yield partial(conductor._refresh, executor)


def test_a_match_is_recorded_while_the_conductor_computes_a_board(
    season: Conducted, monkeypatch: pytest.MonkeyPatch
) -> None:
    arriving = play_ladder(season)

    def fit_slowly(matches: Sequence[RatedMatch]) -> Fit:
        if arriving:
            assert season.played(arriving.pop()), "nobody else may write meanwhile"
        return fit(matches)

    monkeypatch.setattr("wildscav_evaluator.ratings.fit.fit", fit_slowly)
    with refreshing(season) as refresh_boards:
        refresh_boards(at_once=True)
        assert season.board("battle") is None, "a board that lacks a result has no mark of all"
        refresh_boards(at_once=True)
    board = season.board("battle")
    with season.database.reading() as session:
        played = session.scalar(select(func.count()).where(Match.track == "battle", Match.state == FINISHED))
    assert board.applied == played


def test_matches_are_planned_without_a_fit_in_the_transaction(
    season: Conducted, monkeypatch: pytest.MonkeyPatch
) -> None:
    play_ladder(season)
    ladder_rows(season)
    with season.database.reading() as session:
        rate_ladders(session, season.season)
    monkeypatch.setattr("wildscav_evaluator.ratings.fit.fit", None)
    assert season.plan() > 0


@pytest.mark.parametrize(("computed", "second"), [({}, 115.0), ({"of which something changed": None}, 107.0)])
def test_boards_that_take_long_are_made_more_rarely_but_those_left_out_follow_soon(
    season: Conducted, monkeypatch: pytest.MonkeyPatch, computed: dict[str, None], second: float
) -> None:
    clock = [100.0]
    made = []

    def compute_slowly(*_: object) -> dict[str, None]:
        made.append(clock[0])
        clock[0] += 5.0
        return computed

    monkeypatch.setattr("wildscav_leaderboard.conductor.conductor.compute", compute_slowly)
    monkeypatch.setattr("time.monotonic", lambda: clock[0])
    with refreshing(season) as refresh_boards:
        for _ in range(90):
            refresh_boards()
            clock[0] += 1.0
    assert made[:2] == [100.0, second]


def ladder_rows(season: Conducted) -> dict[int | None, LadderRow]:
    """Bring the ladder up to date, and return its rows by submission."""
    season.refresh()
    return {row.submission: row for row in season.board("battle").rows}


def test_a_submission_that_is_restored_keeps_its_rating(season: Conducted) -> None:
    season.active("owls", ("battle",))
    fox = season.active("foxes", ("battle",))
    season.plan()
    for attempt, _ in season.take_matches(20)[:-1]:
        assert season.played(attempt)
    before = ladder_rows(season)
    assert before[fox].matches >= 2

    season.decide("disable", fox)
    assert ladder_rows(season).keys() == before.keys() - {fox}
    season.decide("restore", fox)
    assert ladder_rows(season) == before


BOTH = ("navigation", "battle")


@pytest.fixture
def three(tmp_path: Path) -> Iterator[Conducted]:
    """A season whose ladder seats three, one of them the robot."""
    season = make_season(tmp_path / "season")
    battle = season.settings.tracks["battle"].model_copy(update={"seats": 3})
    with conducting(changed(season, tracks={**season.settings.tracks, "battle": battle})) as conducted:
        yield conducted


def missing(three: Conducted) -> dict[str, int]:
    with three.database.reading() as session:
        return missing_entrants(session, three.season)


def test_a_ladder_waits_for_teams_and_not_for_submissions(three: Conducted) -> None:
    assert missing(three) == {"battle": 2}
    three.active("foxes", BOTH)
    assert missing(three) == {"battle": 1}
    three.active("foxes", BOTH)  # those of one team never meet
    assert missing(three) == {"battle": 1}
    three.active("owls", ("navigation",))  # does not play there
    assert missing(three) == {"battle": 1}
    three.active("owls", ("battle",))
    assert missing(three) == {}


def test_progress_counts_what_is_played_of_what_is_planned(three: Conducted) -> None:
    number = three.active("foxes", BOTH)
    with three.database.reading() as session:
        found = progress_of(session, three.season, three.submission(number))
    assert [tuple(vars(one).values()) for one in found] == [("navigation", 0, 2, 0), ("battle", 0, 100, 1)]


def test_totals_of_a_suite_are_told_when_all_of_its_matches_are_over(three: Conducted) -> None:
    number = three.active("foxes", BOTH)
    found = []
    for score in (3.0, 5.0):
        ((attempt, _),) = three.take_matches(1)
        assert three.played(attempt, score)
        with three.database.reading() as session:
            found.append(totals_of(session, three.submission(number)))
    assert found == [[], [TotalsView(track="navigation", matches=2, score=4.0, faults={})]]


def apply_longer_matches(season: Conducted) -> None:
    """Let the suite of navigation have matches of 5 s instead of 4 s from now on."""
    path = season.season.folder / "tiny.toml"
    path.write_text(path.read_text().replace("time_limit = 4 }", "time_limit = 5 }"))
    season.season = Season.open(season.season.folder)
    season.write(lambda session: apply_editions(session, season.season, "anna", season.now))


def test_totals_and_progress_count_the_rules_in_force_and_the_results_that_took_the_place_of_others(
    season: Conducted,
) -> None:
    def seen(score: float | None) -> tuple[list[TotalsView], tuple[int, int]]:
        """Play all that waits with a score; return the foxes' totals and progress."""
        for attempt, _ in season.take_matches(8) if score is not None else ():
            assert season.played(attempt, score)
        with season.database.reading() as session:
            (progress,) = progress_of(session, season.season, season.submission(1))
            return totals_of(session, season.submission(1)), (progress.played, progress.planned)

    def totals(score: float) -> list[TotalsView]:
        return [TotalsView(track="navigation", matches=2, score=score, faults={})]

    assert seen(1.0) == (totals(1.0), (2, 2))
    apply_longer_matches(season)
    assert seen(None) == ([], (0, 2))
    assert seen(3.0) == (totals(3.0), (2, 2))
    season.act(acts.rejudge, submission="1", reason="a disk failed")
    assert seen(None) == ([], (2, 2)), "the totals are told when all results have arrived"
    assert seen(9.0) == (totals(9.0), (2, 2))


def test_a_disqualified_team_leaves_the_boards_of_earlier_editions_too(season: Conducted) -> None:
    def teams() -> list[str]:
        season.refresh()
        return [row.team for row in season.board("navigation", audience_of(1)).rows]

    for attempt, _ in season.take_matches(4):
        assert season.played(attempt)
    apply_longer_matches(season)
    assert sorted(teams()) == ["foxes", "owls"]
    season.act(acts.disqualify_team, "owls", reason="cheats")
    assert teams() == ["foxes"]
    season.act(acts.requalify_team, "owls", reason="a mistake")
    assert sorted(teams()) == ["foxes", "owls"]


def test_whatever_takes_no_part_has_no_progress(three: Conducted) -> None:
    number = three.hand_in("foxes", BOTH)
    with three.database.reading() as session:
        assert progress_of(session, three.season, three.submission(number)) == []
