"""`wildscav tournament`: submissions play each other, and their ratings follow from the records alone."""

import json
import shutil
from pathlib import Path

import pytest
import typer
from tests.commands import run_command
from tests.end_to_end.pages import json_documents
from tests.evaluator.conftest import submission_in
from tests.evaluator.interrupted_runs import Sitting, check_whole, entered, files, without_timings
from tests.evaluator.sample_agents import CRASHER, WALKER, Command
from tests.evaluator.warm_workers import WarmWorkers, playing_with
from typer.testing import CliRunner

from wildscav.errors import UserError
from wildscav_engine.record import read_record
from wildscav_evaluator.cli.commands.tournament import tournament
from wildscav_evaluator.cli.options.evaluation import TournamentOptions
from wildscav_evaluator.cli.options.tournament import chosen_settings, most_entries
from wildscav_evaluator.cli.sessions.rescore import run_rescore
from wildscav_evaluator.executors.local import LocalExecutor
from wildscav_evaluator.output.results import read_results
from wildscav_evaluator.submissions.submission import load_submission
from wildscav_evaluator.suites.suite_file import read_suite
from wildscav_evaluator.tournaments.tournament_file import Tournament, tournament_of

pytestmark = pytest.mark.usefixtures("compiled")

app = typer.Typer()
app.command()(tournament)

# Short matches on a small map.
SUITE = """
name = "arena"
map = { size = 40, houses = 0 }
[tracks.battle]
maps = 2
match = { time_limit = 3.0, supplies = { waves = [{ center = [0, 0], radius = 20 }] } }
[tracks.capture]
maps = 1
match = { time_limit = 3.0 }
"""
TRACKS = '["battle"]'


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("tournament")


@pytest.fixture(scope="module")
def suite(place: Path) -> Path:
    path = place / "arena.toml"
    path.write_text(SUITE)
    return path


@pytest.fixture(scope="module")
def entrants(place: Path) -> tuple[str, ...]:
    """One that walks, one that crashes in every match, and two robots."""
    walker = submission_in(place, "walker", WALKER, tracks=TRACKS)
    crasher = submission_in(place, "crasher", CRASHER, tracks=TRACKS)
    return str(walker.folder), str(crasher.folder), "robot:gatherer-hard", "robot:walker-easy"


def arguments(entrants: tuple[str, ...], suite: Path, *more: str) -> list[str]:
    chosen = ["--track=battle", f"--suite={suite}", "--sandbox=process", "--workers=1", "--replays=none"]
    return [*entrants, *chosen, "--seats=2", "--rounds=3", *more]


@pytest.fixture(scope="module")
def document(
    entrants: tuple[str, ...], suite: Path, place: Path, warm_workers: WarmWorkers
) -> dict[str, object]:
    """What is printed of a tournament that is in the folder ``out`` of the place."""
    with playing_with(warm_workers):
        done = run_command("tournament", *arguments(entrants, suite), f"--out={place / 'out'}", "--json")
    assert done.returncode == 1, done.stderr
    assert "crasher failed in every match of battle" in done.stderr
    printed: dict[str, object] = json.loads(
        done.stdout[done.stdout.index("{\n") : done.stdout.rindex("}") + 1]
    )
    assert printed.keys() == json_documents()["tournament"]
    return printed


@pytest.fixture
def played(document: dict[str, object], place: Path, tmp_path: Path) -> tuple[Path, dict[str, object]]:
    """A copy of the tournament's folder, and what was printed."""
    return shutil.copytree(place / "out", tmp_path / "out"), document


def test_a_crash_costs_the_seat_of_the_crasher_and_nobody_elses(
    played: tuple[Path, dict[str, object]], tmp_path: Path, wildscav: Command
) -> None:
    out, document = played
    results = read_results(out / "results.json")
    by_name = {one.submission: one for one in results.evaluations}
    assert list(by_name) == ["crasher", "robot:gatherer-hard", "robot:walker-easy", "walker"]
    assert {name: one.faults for name, one in by_name.items()} == {
        "crasher": 6,
        "robot:gatherer-hard": 0,
        "robot:walker-easy": 0,
        "walker": 0,
    }
    assert {row.status for row in by_name["crasher"].matches} == {"crashed"}
    assert all(len(one.matches) == 6 for one in by_name.values())
    shared = [row.record for one in by_name.values() for row in one.matches]
    assert len(shared) == 2 * len(set(shared)), "both entrants of a match have one record"

    tournament = Tournament.read(out / "tournament.json")
    assert tournament == tournament_of(results)
    assert document["tournament"] == tournament.as_json()
    best, *_, last = (one.entrant for one in tournament.ratings.standings)
    assert (best, last) == ("robot:gatherer-hard", "crasher")

    run_rescore(out, LocalExecutor(1))  # the records alone give the same ratings
    verified = wildscav("verify", *sorted((out / "records").glob("*.wsr")))
    assert verified.returncode == 0, verified.stdout + verified.stderr

    board = wildscav("leaderboard", out, "--json")
    stored = json.loads(board.stdout[board.stdout.index("{") : board.stdout.rindex("\n}") + 2])
    assert stored["tournaments"] == [tournament.as_json()]
    assert "battle · 4 entrants · 12 matches · suite arena" in wildscav("leaderboard", out).stdout


@pytest.mark.slow
def test_the_order_of_the_entrants_changes_nothing(
    played: tuple[Path, dict[str, object]],
    entrants: tuple[str, ...],
    suite: Path,
    tmp_path: Path,
    wildscav: Command,
) -> None:
    out, _ = played
    other = tmp_path / "other"
    wildscav("tournament", *arguments(entrants[::-1], suite), f"--out={other}")
    assert (other / "tournament.json").read_bytes() == (out / "tournament.json").read_bytes()
    assert (other / "evaluation.json").read_bytes() == (out / "evaluation.json").read_bytes()
    assert files(other, "records") == files(out, "records")
    assert without_timings(other) == without_timings(out)


@pytest.mark.slow
def test_a_tournament_that_was_killed_goes_on_where_it_was(
    played: tuple[Path, dict[str, object]], entrants: tuple[str, ...], suite: Path, tmp_path: Path
) -> None:
    whole, _ = played
    out = tmp_path / "killed"
    for least in (0, 5):
        Sitting(out, *arguments(entrants, suite), verb="tournament").kill_at(least)
        check_whole(out)
    before = entered(out)
    last = Sitting(out, *arguments(entrants, suite), verb="tournament")
    last.process.wait(120)
    assert {stem: entered(out)[stem] for stem in before} == before, "a match was played again"
    assert without_timings(out) == without_timings(whole)
    assert (out / "tournament.json").read_bytes() == (whole / "tournament.json").read_bytes()
    assert files(out, "records") == files(whole, "records")
    run_rescore(out, LocalExecutor(1))


def test_changed_ratings_and_exchanged_records_are_found_out(
    played: tuple[Path, dict[str, object]], capsys: pytest.CaptureFixture[str]
) -> None:
    out, _ = played
    found = Tournament.read(out / "tournament.json")
    best, *others = found.ratings.standings
    lie = found.ratings.model_copy(
        update={"standings": (best.model_copy(update={"rating": best.rating + 50}), *others)}
    )
    found.model_copy(update={"ratings": lie}).write(out / "tournament.json")
    with pytest.raises(UserError) as refused:
        run_rescore(out, LocalExecutor(1))
    assert "tournament.json" in str(refused.value)

    # Two matches of one game have the same spec, and other entrants in the seats.
    records = (out / "records").glob("*.wsr")
    agents_alone = [path for path in records if set(read_record(path).spec.seats) == {"submission"}]
    first, second = sorted(agents_alone)
    assert read_record(first).spec == read_record(second).spec
    content = first.read_bytes()
    first.write_bytes(second.read_bytes())
    second.write_bytes(content)
    with pytest.raises(UserError) as refused:
        run_rescore(out, LocalExecutor(1))
    said = capsys.readouterr().err + str(refused.value)
    number = int(first.stem.removeprefix("battle-"))
    assert f"records/{first.name}: is not match {number} of the tournament" in said


@pytest.mark.parametrize(
    ("more", "error"),
    [
        (("robot:gatherr",), "there is no robot 'gatherr' (did you mean 'gatherer'"),
        (("robot:walker-easy",), "robot:walker-easy is entered twice"),
        (("--seats=6",), "a match with 6 seats needs 6 entrants; 4 are named: give fewer --seats"),
        (("--seats=3", "--team-size=2"), "--seats is 3, must be a multiple of the team size 2"),
        (("--mixed", "--team-size=3", "--seats=6"), "two mixed teams of 3 need 6 entrants; 4 are named"),
        (("--mixed",), "--mixed needs teams of two or more seats"),
        (("--robots=fighter,nobody",), "there is no robot 'nobody'"),
        ((f"--robots={'9' * 5000}",), "a match has at most 1,000 seats, and so here at most 998 robots"),
        (("--robots=999",), "a match has at most 1,000 seats, and so here at most 998 robots"),
        (("walker-easy",), "no submission 'walker-easy'; to enter the robot, write robot:walker-easy"),
        (("--repeats=5",), "such a tournament is not possible: "),
        (("--track=chess",), "there is no track 'chess'"),
        (("--track=navigation",), "suite arena has no track navigation"),
        (("--track=capture",), "does not play capture"),
        (("nowhere",), "submission nowhere does not exist"),
    ],
)
def test_what_cannot_be_played_is_refused_in_one_line(
    entrants: tuple[str, ...],
    suite: Path,
    tmp_path: Path,
    more: tuple[str, ...],
    error: str,
) -> None:
    out = tmp_path / "out"
    done = refused(*arguments(entrants, suite, *more), f"--out={out}")
    assert error in done
    assert not out.exists()


def test_two_versions_meet_others_by_default_and_each_other_never(
    entrants: tuple[str, ...], suite: Path, tmp_path: Path
) -> None:
    walker = Path(entrants[0])
    newer = tmp_path / "newer"
    shutil.copytree(walker, newer)
    manifest = newer / "submission.toml"
    manifest.write_text(manifest.read_text().replace("1.0.0", "2.0.0"))
    options = ["--track=battle", f"--suite={suite}", "--sandbox=process"]
    done = refused(str(walker), str(newer), "robot:walker", *options)
    assert "2 of the 3 entrants are entries of one submission, which do not meet" in done

    versions = [load_submission(walker), load_submission(newer)]
    settings = chosen_settings(TournamentOptions(), 4, most_entries(versions), read_suite(suite), "battle")
    assert settings.seats == 2, "a match of three or more would have both versions in it sometimes"


def test_a_game_is_repeated_a_thousand_times_at_most(entrants: tuple[str, ...], suite: Path) -> None:
    done = CliRunner().invoke(app, arguments(entrants, suite, "--repeats=1001"))
    assert done.exit_code == 2, "a wrong option, and no traceback"


def test_a_tournament_needs_two_entrants(suite: Path) -> None:
    done = refused(*arguments(("robot:walker",), suite))
    assert "a tournament has 2 to 1,000 entrants; 1 entrant is named" in done


def refused(*arguments: str) -> str:
    """The error of the command, which is run in this process."""
    done = CliRunner().invoke(app, arguments)
    assert isinstance(done.exception, UserError)
    assert done.exception.exit_code == 2
    return str(done.exception)
