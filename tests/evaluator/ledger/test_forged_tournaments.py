"""Attempts to forge a tournament's folder: all are found out, even while its seed is hidden."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from tests.evaluator.ledger.forging import Forgery, Rescored, copied
from tests.evaluator.warm_workers import WarmWorkers, playing_with

from wildscav.errors import UserError
from wildscav_engine.record import read_record, write_record
from wildscav_engine.simulation.match import Match
from wildscav_evaluator.cli.sessions.rescore import run_rescore
from wildscav_evaluator.cli.sessions.tournament import run_tournament
from wildscav_evaluator.executors.local import LocalExecutor
from wildscav_evaluator.monitoring.monitor import MonitorOptions
from wildscav_evaluator.output.layout import LEDGER_FILE, OPENED_FILE, RESULTS_FILE
from wildscav_evaluator.output.results import MatchRow, TournamentSettings
from wildscav_evaluator.plans.tournament import TournamentPlan
from wildscav_evaluator.scores.expected_matches import check_opened
from wildscav_evaluator.scores.score import summary
from wildscav_evaluator.suites.seeds import new_secret, read_secret
from wildscav_evaluator.suites.suite_file import read_suite
from wildscav_evaluator.tournaments.tournament_file import tournament_of

SUITE = """
name = "arena"
map = { size = 40, houses = 0 }
[tracks.battle]
maps = 2
match = { time_limit = 2.0, supplies = { waves = [{ center = [0, 0], radius = 20 }] } }
"""
LOSER, OTHER = "robot:gatherer", "robot:walker-easy"


@pytest.fixture(scope="module")
def secret(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("organizer") / "secret"
    path.write_bytes(new_secret())
    return path


@pytest.fixture(scope="module")
def played(tmp_path_factory: pytest.TempPathFactory, secret: Path, warm_workers: WarmWorkers) -> Path:
    """Four robots in twelve matches of two, on a hidden seed."""
    folder = tmp_path_factory.mktemp("tournament")
    (folder / "arena.toml").write_text(SUITE)
    plan = TournamentPlan(
        submissions=(),
        robots=("fighter", "gatherer", "gatherer-hard", "walker-easy"),
        track="battle",
        settings=TournamentSettings(seats=2),
        suite=read_suite(folder / "arena.toml"),
        seed=read_secret(secret),
        rounds=3,
        replays="none",
        jobs=1,
        out=folder / "out",
    )
    with playing_with(warm_workers):
        run_tournament(plan, MonitorOptions())
    return plan.out


@pytest.fixture
def forgery(played: Path, tmp_path: Path) -> Forgery:
    return copied(played, tmp_path / "out")


def seal(forgery: Forgery) -> None:
    """Have the ratings and the ledger say what the results say."""
    tournament_of(forgery.results).write(forgery.out / "tournament.json")
    forgery.rewrite_ledger()


def drop(forgery: Forgery) -> None:
    """Leave a match out for both of its entrants."""
    index = forgery.evaluation(LOSER).matches[0].index
    (forgery.out / "records" / f"battle-{index:03d}.wsr").unlink()
    for one in forgery.results.evaluations:
        forgery.change_matches(one.submission, lambda row: None if row.index == index else row)
    timings = forgery.results.timings
    left = tuple(one for one in timings.matches if one.index != index)
    forgery.tell(timings=timings.model_copy(update={"matches": left}))


def give_away(forgery: Forgery) -> None:
    """Give the seat of one entrant in a match to another one, in the record and in the results."""
    loser, other = forgery.evaluation(LOSER), forgery.evaluation(OTHER)
    known = {row.index for row in other.matches}
    lost = next(row for row in loser.matches if row.index not in known)
    path = forgery.out / str(lost.record)
    record = read_record(path)
    match = Match(record.spec)
    while not match.over:
        match.step(np.zeros((len(record.names), 8), np.float32))
    write_record(path, match, tuple(OTHER if name == LOSER else name for name in record.names))

    seats = tuple(seat.model_copy(update={"submission": OTHER}) for seat in lost.seats)
    forgery.change_matches(LOSER, lambda row: None if row.index == lost.index else row)
    rows = sorted((*other.matches, MatchRow.of(lost.index, seats, lost.record)), key=lambda row: row.index)
    forgery.tell_of(OTHER, matches=tuple(rows), summary=summary(other.metrics, rows))


def claim_robots(forgery: Forgery) -> None:
    """Say that a robot played in every match, too."""
    settings = TournamentSettings(seats=2, robots=("fighter",))
    forgery.tell(tournament=settings)
    forgery.identify(tournament=settings)


def claim_rounds(forgery: Forgery) -> None:
    """Say that more rounds were played."""
    forgery.tell(rounds=4)
    forgery.identify(rounds=4)


def make_older(forgery: Forgery, secret: Path) -> None:
    """Say that an earlier version of Wildscav made the schedule, and open the secret."""
    settings = TournamentSettings(seats=2, schedule=1)
    forgery.tell(tournament=settings)
    forgery.identify(tournament=settings)
    (forgery.out / OPENED_FILE).write_bytes(secret.read_bytes())


def exchange_games(forgery: Forgery) -> None:
    """Exchange the records of the first two games, which are on two maps."""
    first, second = (forgery.out / "records" / f"battle-{index:03d}.wsr" for index in (0, 2))
    aside = first.rename(first.with_name("aside"))
    second.rename(first)
    aside.rename(second)


HIDDEN = {
    "a match left out": (drop, "of the tournament has results of 0 entrants, must be 2"),
    "a seat given away": (
        give_away,
        f"{OTHER} on battle: 7 matches in the results, but every entrant of the tournament plays 6",
    ),
    "robots that were not there": (
        claim_robots,
        "records/battle-000.wsr: its seats are not filled as the settings of the tournament say",
    ),
    "more rounds": (claim_rounds, "match 12 of the tournament has results of 0 entrants, must be 2"),
}


def test_a_tournament_as_it_was_played_is_borne_out(
    forgery: Forgery, secret: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    run_rescore(forgery.out, LocalExecutor(1))
    assert "can be checked once its secret is opened" in capsys.readouterr().out
    seal(forgery)
    (forgery.out / OPENED_FILE).write_bytes(secret.read_bytes())
    run_rescore(forgery.out, LocalExecutor(1))


@pytest.mark.parametrize("name", HIDDEN)
def test_a_forgery_is_found_out_though_nobody_signed_and_the_seed_is_hidden(
    forgery: Forgery, rescored: Rescored, name: str
) -> None:
    forge, line = HIDDEN[name]
    forge(forgery)
    seal(forgery)
    assert line in rescored(forgery)


def test_a_seat_given_away_is_named_once_the_secret_is_opened(
    forgery: Forgery, rescored: Rescored, secret: Path
) -> None:
    (forgery.out / OPENED_FILE).write_bytes(secret.read_bytes())
    give_away(forgery)
    seal(forgery)
    assert ".wsr: is not match " in rescored(forgery)


def test_a_schedule_that_is_not_made_any_more_is_checked_as_it_was_played(
    forgery: Forgery,
    rescored: Rescored,
    secret: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.delattr("wildscav_evaluator.tournaments.drawing.make_schedule")
    make_older(forgery, secret)
    seal(forgery)
    run_rescore(forgery.out, LocalExecutor(1))
    assert "Its schedule is of an earlier version" in capsys.readouterr().out
    commitment = forgery.results.commitment
    assert commitment is not None
    assert check_opened(forgery.out, commitment) == 12

    exchange_games(forgery)
    seal(forgery)
    assert "records/battle-000.wsr: is not match 0 of the tournament" in rescored(forgery)
    with pytest.raises(UserError, match=r"battle-000.wsr is not of a match that the secret determines"):
        check_opened(forgery.out, commitment)


def test_a_seat_given_away_is_named_in_an_older_schedule_too(
    forgery: Forgery, rescored: Rescored, secret: Path
) -> None:
    make_older(forgery, secret)
    give_away(forgery)
    seal(forgery)
    assert "other entrants play in it than in another match of the same game" in rescored(forgery)


def test_another_team_is_named(forgery: Forgery, rescored: Rescored) -> None:
    def moved(row: MatchRow) -> MatchRow:
        seats = tuple(seat.model_copy(update={"team": 7}) for seat in row.seats)
        return row.model_copy(update={"seats": seats})

    forgery.change_matches(LOSER, moved)
    seal(forgery)
    said = rescored(forgery)
    assert f"of {LOSER} in team 7 (" in said
    assert f"of {LOSER} in team 1 (" in said


def break_records_of_a_killed_run(forgery: Forgery) -> None:
    for path in (forgery.out / "records").iterdir():
        path.write_bytes(b"nothing")
    (forgery.out / RESULTS_FILE).unlink()
    (forgery.out / LEDGER_FILE).unlink()


@pytest.mark.parametrize(
    "ruin",
    [break_records_of_a_killed_run, lambda forgery: forgery.tell_of(LOSER, track="royale")],
    ids=["broken", "another track"],
)
def test_what_cannot_be_rated_ends_in_lines_that_say_why(
    forgery: Forgery, rescored: Rescored, ruin: Callable[[Forgery], None]
) -> None:
    ruin(forgery)
    assert "there are no ratings: the results are not those of a tournament on one track" in rescored(forgery)


@pytest.mark.parametrize("seed", ["9" * 5000, "none"])
def test_a_killed_run_with_any_seed_is_rescored(
    forgery: Forgery, seed: str, capsys: pytest.CaptureFixture[str]
) -> None:
    forgery.identify(seed=seed)
    (forgery.out / RESULTS_FILE).unlink()
    (forgery.out / LEDGER_FILE).unlink()
    run_rescore(forgery.out, LocalExecutor(1))
    assert "seed unknown" in capsys.readouterr().out


def test_a_record_of_a_tournament_does_not_count_in_an_evaluation(
    signed: Forgery, rescored: Rescored
) -> None:
    """Without the submission in its name, a record could give the seats to any submissions."""
    record = signed.record("ada", 0)
    renamed = record.rename(record.with_name("navigation-000.wsr"))

    def with_record(row: MatchRow) -> MatchRow:
        path = f"records/{renamed.name}" if row.index == 0 else row.record
        return row.model_copy(update={"record": path})

    signed.change_matches("ada", with_record)
    signed.rewrite_ledger()
    assert "records/navigation-000.wsr: is not named as the records of an evaluation are" in rescored(signed)
