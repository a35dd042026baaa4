"""`wildscav evaluate` as its user runs it: agents in processes, files on disk, one clear line for errors."""

import json
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from tests.evaluator.results_by_hand import identity_of, results_of
from tests.evaluator.sample_agents import WALKER, Command, Submit
from tests.evaluator.warm_workers import WarmWorkers, playing_with

from wildscav_engine.record import read_record, save, verify_record
from wildscav_evaluator.cli.sessions.playing import saving_errors
from wildscav_evaluator.ledger.writer import LedgerWriter
from wildscav_evaluator.output.results import KeptLimits, Results, read_results
from wildscav_evaluator.submissions.submission import folder_digest

pytestmark = pytest.mark.usefixtures("compiled")
SUITE = """
name = "short"
map = { size = 40, houses = 1 }
[tracks.navigation]
maps = 2
match = { time_limit = 6 }
"""


@pytest.fixture
def one_worker(warm_workers: WarmWorkers) -> Iterator[None]:
    """Evaluations share a worker."""
    with playing_with(warm_workers):
        yield


@pytest.fixture
def worker_of_one_folder() -> Iterator[None]:
    """Evaluations of one working directory, in which the first of them starts it, share a worker."""
    with WarmWorkers() as workers, playing_with(workers):
        yield


@pytest.fixture
def short(tmp_path: Path) -> Path:
    """The file of a suite with two short matches."""
    path = tmp_path / "short.toml"
    path.write_text(SUITE)
    return path


def evaluate(
    wildscav: Command, *folders: Path, out: Path, **options: object
) -> "subprocess.CompletedProcess[str]":
    arguments = [f"--{name}={value}" for name, value in options.items()]
    return wildscav("evaluate", *folders, f"--out={out}", *arguments)


def complaint(done: "subprocess.CompletedProcess[str]") -> str:
    """The one line that says what is wrong."""
    (line,) = complaints(done)
    return line


def complaints(done: "subprocess.CompletedProcess[str]") -> list[str]:
    """The lines that say what is wrong, one a fault."""
    assert "Traceback" not in done.stderr + done.stdout
    return [line for line in done.stderr.splitlines() if line.startswith("wildscav: ")]


@pytest.mark.slow
@pytest.mark.usefixtures("one_worker")
def test_a_failing_agent_harms_nobody(
    wildscav: Command, pair: tuple[Path, Path], short: Path, tmp_path: Path
) -> None:
    done = evaluate(wildscav, *pair, out=tmp_path, suite=short, replays="first")

    assert done.returncode == 1
    assert "crasher failed in every match of navigation" in complaint(done)
    assert r"RuntimeError: lost the thread \x1b[2J[/]\u202e" in complaint(done)
    assert not {"\x1b", "\u202e"} & set(done.stdout + done.stderr), "no agent's text steers the terminal"

    results = read_results(tmp_path / "results.json")
    walker, crasher = results.evaluations
    assert (walker.submission, walker.faults, len(walker.matches)) == ("walker", 0, 2)
    assert (crasher.submission, crasher.faults, len(crasher.matches)) == ("crasher", 2, 2)
    assert {row.status for row in crasher.matches} == {"crashed"}
    assert crasher.score is not None, "a match that an agent left is scored as it stands"
    assert results.sandbox == "process"
    assert results.limits == {"navigation": KeptLimits(output=1_000_000)}
    check_files(tmp_path, results)
    check_table(done.stdout)


def check_files(out: Path, results: Results) -> None:
    """Every match has its record, which holds; the first of each submission has a replay."""
    for evaluation in results.evaluations:
        assert [row.replay is not None for row in evaluation.matches] == [True] + [False] * (
            len(evaluation.matches) - 1
        )
        for row in evaluation.matches:
            assert row.record is not None
            assert (out / row.record).stat().st_size > 0
        assert evaluation.matches[0].replay is not None
        assert (out / evaluation.matches[0].replay).stat().st_size > 1000
    (log,) = results.evaluations[1].matches[0].logs
    assert "lost the thread" in (out / log).read_text()
    record = read_record(out / str(results.evaluations[0].matches[0].record))
    assert verify_record(record).holds


def check_table(output: str) -> None:
    assert "navigation · suite short@" in output
    assert "walker 1.0.0" in output
    assert "success" in output
    said = " ".join(output.split())
    assert "sandbox process; each agent: 1 MB of output" in said
    assert "time of the agents, measured at the engine" in said
    assert "results.json" in output
    assert "wildscav verify" in output
    assert ".rrd" in output


@pytest.mark.slow
@pytest.mark.usefixtures("one_worker")
def test_invalid_actions_are_counted_and_told(
    wildscav: Command, submit: Submit, short: Path, tmp_path: Path
) -> None:
    runner = submit("runner", "    def act(self, observation): return Action(walk_speed=99.0, shoot=True)")
    walker = submit("walker", WALKER)

    done = evaluate(wildscav, runner.folder, walker.folder, out=tmp_path, suite=short, replays="none")

    first, second = read_results(tmp_path / "results.json").evaluations
    assert done.returncode == 0
    ones, others = ([row.seats[0] for row in one.matches] for one in (first, second))
    assert all(seat.invalid_actions == seat.actions > 50 for seat in ones)
    assert all(seat.invalid_actions == seat.ignored_fields == 0 < seat.actions for seat in others)
    total = sum(seat.actions for seat in ones)
    said = " ".join(done.stdout.split())
    assert f"runner on navigation: {total:,} of {total:,} actions were invalid" in said
    assert "walk_speed must be 0 to 10 m/s" in said
    assert "walker on navigation: " not in said.replace("walker on navigation: 2 matches", "")


@pytest.mark.slow
@pytest.mark.usefixtures("one_worker")
def test_a_record_with_one_action_changed_no_longer_holds(
    wildscav: Command, submit: Submit, short: Path, tmp_path: Path
) -> None:
    evaluate(wildscav, submit("walker", WALKER).folder, out=tmp_path, suite=short, replays="none")
    path = tmp_path / "records" / "navigation-000-walker.wsr"
    record = read_record(path)
    actions = record.actions.copy()
    actions.view(np.uint8)[record.steps // 2, 0, 1] ^= 1

    save(replace(record, actions=actions), path)  # with a checksum that fits

    done = wildscav("verify", path)
    assert done.returncode == 1
    assert f"step {record.steps // 2 + 1}" in done.stdout + done.stderr
    assert wildscav("verify", tmp_path / "records" / "navigation-001-walker.wsr").returncode == 0


@pytest.mark.parametrize(
    ("arguments", "code", "says"),
    [
        (["nowhere"], 2, "submission nowhere does not exist"),
        (
            ["{walker}", "--track", "fishing"],
            2,
            "no track 'fishing'; the tracks are navigation, gathering, capture, battle, royale",
        ),
        (["{walker}", "--track", "battle"], 2, "'walker' does not play battle"),
        (["{walker}", "{walker}"], 2, "two submissions are called 'walker'"),
        (["{walker}", "--out", "{walker}"], 2, "walker is the folder of a submission"),
        (["{walker}", "--out", "{walker}/out/deep"], 2, "walker/out/deep is in the folder of a submission"),
        (["{walker}", "--interface", "words"], 2, "'walker' plays by numbers, as its submission.toml says"),
        (["{walker}", "--out", "{other}/out"], 2, "other/out is in the folder of a submission"),
        (
            ["{walker}", "--out", "/dev/null/out"],
            2,
            "--out /dev/null/out cannot be made: /dev/null is not a folder",
        ),
    ],
)
def test_bad_input_is_one_clear_line(
    wildscav: Command, submit: Submit, arguments: list[str], code: int, says: str
) -> None:
    walker, other = submit("walker", WALKER), submit("other", WALKER)
    folders = {"walker": walker.folder, "other": other.folder}

    done = wildscav("evaluate", *(argument.format(**folders) for argument in arguments))

    assert done.returncode == code
    assert says in complaint(done)
    assert walker.digest == folder_digest(walker.folder)


@pytest.mark.parametrize("arguments", [["--suite", "slow"], ["--workers", "0"], ["--seed", "x"], []])
def test_bad_options_are_usage_errors(wildscav: Command, arguments: list[str]) -> None:
    assert wildscav("evaluate", *arguments, *(["folder"] if arguments else [])).returncode == 2


@pytest.mark.slow
def test_a_full_disk_ends_the_evaluation_in_one_clear_line(submit: Submit, tmp_path: Path) -> None:
    walker, out = submit("walker", WALKER), tmp_path / "out"
    arguments = ["evaluate", walker.folder, f"--out={out}", "--replays=none"]
    done = run_with_file_limit(arguments)

    assert done.returncode == 1
    # What is not in the ledger does not count, so nothing more is played.
    assert f"the ledger {out / 'ledger.jsonl'} cannot be written: " in complaint(done)
    assert not list(out.rglob("results.json*")), "no half-written file is left"


def run_with_file_limit(arguments: list[object]) -> "subprocess.CompletedProcess[str]":
    """Run a command that cannot write a file beyond 1.5 or 3 kB: as on a full disk, writes fail."""
    program = Path(sys.executable).parent / "wildscav"
    command = ["sh", "-c", 'ulimit -f 3 && exec "$@"', "sh", str(program), *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, timeout=300)


TINY = """
name = "tiny"
[map]
size = 40
houses = 1
[tracks.navigation]
maps = 7
episodes = 1
match = { time_limit = 2 }
"""


@pytest.mark.slow
@pytest.mark.usefixtures("worker_of_one_folder")
def test_an_edited_agent_is_evaluated_beside_its_former_self(
    wildscav: Command, submit: Submit, tmp_path: Path
) -> None:
    folder = submit("mine", WALKER).folder
    (tmp_path / "tiny.toml").write_text(TINY)
    arguments = ("evaluate", folder, "--suite=tiny.toml", "--replays=none")

    first = wildscav(*arguments, cwd=tmp_path)
    assert first.returncode == 0, first.stderr
    assert "since last time" not in first.stdout

    manifest = folder / "submission.toml"
    manifest.write_text(manifest.read_text().replace("1.0.0", "2.0.0"))
    (folder / "agent.py").write_text((folder / "agent.py").read_text().replace("6.0", "0.0"))
    second = wildscav(*arguments, cwd=tmp_path)
    assert second.returncode == 0, second.stderr
    assert "since last time" in second.stdout
    assert "0001 1.0.0" in " ".join(second.stdout.split())

    again = wildscav(*arguments, "--json", cwd=tmp_path)
    assert again.returncode == 0
    assert "all 7 matches were played before" in again.stderr
    document = json.loads(again.stdout)
    assert document["folder"] == "out/evaluations/0002-mine"
    assert document["results"]["evaluations"][0]["version"] == "2.0.0"
    (since,) = document["since_last"]
    assert (since["folder"], since["version"], since["comparison"]["pairs"]) == ("0001-mine", "1.0.0", 7)

    fresh = wildscav(*arguments, "--fresh", cwd=tmp_path)
    assert fresh.returncode == 0
    assert "played before" not in fresh.stdout
    kept = sorted(path.name for path in (tmp_path / "out" / "evaluations").iterdir())
    assert kept == ["0001-mine", "0002-mine", "0003-mine"]


def test_a_ledger_that_cannot_be_closed_keeps_no_results_from_being_shown(tmp_path: Path) -> None:
    results = results_of("ada")
    ledger = LedgerWriter(tmp_path, identity_of("ada"), None)
    ledger._path = Path("/dev/full")  # the disk is full from here on

    (said,) = saving_errors(results, tmp_path, ledger)

    assert said == "the ledger /dev/full cannot be written: No space left on device"
    assert read_results(tmp_path / "results.json") == results
