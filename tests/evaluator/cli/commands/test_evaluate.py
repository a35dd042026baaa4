"""`wildscav evaluate` as its user runs it: agents in processes, files on disk, one clear line for errors."""

import json
import shutil
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from tests.commands import Done, run_command
from tests.end_to_end.pages import json_documents
from tests.evaluator.conftest import submission_in
from tests.evaluator.results_by_hand import identity_of, results_of
from tests.evaluator.sample_agents import CRASHER, WALKER, Command, Submit
from tests.evaluator.small_matches import tiny_suite
from tests.evaluator.warm_workers import WarmWorkers, playing_with

from wildscav_engine.record import read_record, save, verify_record
from wildscav_evaluator.cli.sessions.playing import saving_errors
from wildscav_evaluator.ledger.writer import LedgerWriter
from wildscav_evaluator.output.results import KeptLimits, read_results
from wildscav_evaluator.submissions.submission import folder_digest

pytestmark = pytest.mark.usefixtures("compiled")


@pytest.fixture(scope="module")
def of_three(tmp_path_factory: pytest.TempPathFactory, warm_workers: WarmWorkers) -> tuple[Path, Done]:
    """The folder of an evaluation of one that walks, one that crashes and one that sends invalid actions."""
    place = tmp_path_factory.mktemp("evaluation")
    runner = "    def act(self, observation): return Action(walk_speed=99.0, shoot=True)"
    bodies = {"walker": WALKER, "crasher": CRASHER, "runner": runner}
    folders = [submission_in(place, name, body).folder for name, body in bodies.items()]
    options = (f"--suite={tiny_suite(place, maps=2, seconds=6)}", "--replays=first")
    with playing_with(warm_workers):
        return place / "out", run_command("evaluate", *folders, f"--out={place / 'out'}", *options)


def complaint(done: Done) -> str:
    """The one line that says what is wrong."""
    assert "Traceback" not in done.stderr + done.stdout
    (line,) = (line for line in done.stderr.splitlines() if line.startswith("wildscav: "))
    return line


@pytest.mark.slow
def test_a_failing_agent_harms_nobody(of_three: tuple[Path, Done]) -> None:
    out, done = of_three

    assert done.returncode == 1
    assert "crasher failed in every match of navigation" in complaint(done)
    assert r"RuntimeError: lost the thread \x1b[2J[/]\u202e" in complaint(done)
    assert not {"\x1b", "\u202e"} & set(done.stdout + done.stderr), "no agent's text steers the terminal"
    results = read_results(out / "results.json")
    assert [(one.submission, one.faults, len(one.matches)) for one in results.evaluations] == [
        ("walker", 0, 2),
        ("crasher", 2, 2),
        ("runner", 0, 2),
    ]
    crasher = results.evaluations[1]
    assert {row.status for row in crasher.matches} == {"crashed"}
    assert crasher.score is not None, "a match that an agent left is scored as it stands"
    assert results.sandbox == "process"
    assert results.limits == {"navigation": KeptLimits(output=1_000_000)}


@pytest.mark.slow
def test_every_match_has_its_record_and_the_first_of_each_submission_a_replay(
    of_three: tuple[Path, Done],
) -> None:
    out, _ = of_three
    walker, crasher, _ = evaluations = read_results(out / "results.json").evaluations

    for first, second in (one.matches for one in evaluations):
        assert (out / str(first.replay)).stat().st_size > 1000
        assert second.replay is None
        assert all((out / str(row.record)).stat().st_size > 0 for row in (first, second))
    (log,) = crasher.matches[0].logs
    assert log == "logs/navigation-000-crasher.log"
    assert "lost the thread" in (out / log).read_text()
    assert verify_record(read_record(out / str(walker.matches[0].record))).holds


@pytest.mark.slow
def test_the_command_shows_scores_times_invalid_actions_and_where_everything_is(
    of_three: tuple[Path, Done],
) -> None:
    out, done = of_three
    said = " ".join(done.stdout.split())
    walker, _, runner = (
        [row.seats[0] for row in one.matches] for one in read_results(out / "results.json").evaluations
    )

    assert all(seat.invalid_actions == seat.actions > 50 for seat in runner)
    assert all(seat.invalid_actions == seat.ignored_fields == 0 < seat.actions for seat in walker)
    total = sum(seat.actions for seat in runner)
    for text in (
        *("navigation · suite tiny@", "walker 1.0.0", "success", "results.json", "wildscav verify", ".rrd"),
        "sandbox process; each agent: 1 MB of output",
        "time of the agents, measured at the engine",
        f"runner on navigation: {total:,} of {total:,} actions were invalid",
        "walk_speed must be 0 to 10 m/s",
    ):
        assert text in said
    assert "walker on navigation: " not in said.replace("walker on navigation: 2 matches", "")


@pytest.mark.slow
def test_a_record_with_one_action_changed_no_longer_holds(
    wildscav: Command, of_three: tuple[Path, Done], tmp_path: Path
) -> None:
    out, _ = of_three
    path = Path(shutil.copy(out / "records" / "navigation-000-walker.wsr", tmp_path))
    record = read_record(path)
    actions = record.actions.copy()
    actions.view(np.uint8)[record.steps // 2, 0, 1] ^= 1
    save(replace(record, actions=actions), path)  # with a checksum that fits

    done = wildscav("verify", path)

    assert done.returncode == 1
    assert f"step {record.steps // 2 + 1}" in done.stdout + done.stderr
    assert wildscav("verify", out / "records" / "navigation-001-walker.wsr").returncode == 0


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
        (["{walker}", "{walker}"], 2, "submission 'walker' is named twice"),
        (["{walker}", "--secret", "{walker}/agent.py"], 2, "walker, where others can see it: move it"),
        (["{walker}", "--out", "mine", "--secret", "mine/seed"], 2, "mine, where others can see it: move it"),
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
    """Files cannot grow beyond 1.5 or 3 kB: as on a full disk, writes fail."""
    out, program = tmp_path / "out", Path(sys.executable).parent / "wildscav"
    arguments = (program, "evaluate", submit("walker", WALKER).folder, f"--out={out}", "--replays=none")
    command = ["sh", "-c", 'ulimit -f 3 && exec "$@"', "sh", *map(str, arguments)]

    done = subprocess.run(command, capture_output=True, text=True, timeout=300)

    assert done.returncode == 1
    # What is not in the ledger does not count, so nothing more is played.
    assert f"the ledger {out / 'ledger.jsonl'} cannot be written: " in complaint(done)
    assert not list(out.rglob("results.json*")), "no half-written file is left"


@pytest.mark.slow
def test_an_edited_agent_is_evaluated_beside_its_former_self(
    wildscav: Command, submit: Submit, tmp_path: Path
) -> None:
    folder = submit("mine", WALKER).folder
    suite = tiny_suite(tmp_path, maps=7, seconds=2)
    arguments = ("evaluate", folder, f"--suite={suite}", "--replays=none", "--json")

    # The first evaluation starts the worker, in the working directory of all.
    with WarmWorkers() as workers, playing_with(workers):
        first = wildscav(*arguments, cwd=tmp_path)
        for file, old, new in (("submission.toml", "1.0.0", "2.0.0"), ("agent.py", "6.0", "0.0")):
            (folder / file).write_text((folder / file).read_text().replace(old, new))
        second, again, fresh = (wildscav(*arguments, *more, cwd=tmp_path) for more in ((), (), ("--fresh",)))

    assert [done.returncode for done in (first, second, again, fresh)] == [0] * 4, first.stderr
    assert "since last time" not in first.stderr
    assert "since last time" in second.stderr
    assert "0001 1.0.0" in " ".join(second.stderr.split())
    assert "all 7 matches were played before" in again.stderr
    assert "played before" not in fresh.stderr
    document = json.loads(again.stdout)
    assert document["folder"] == "out/evaluations/0002-mine"
    assert document["results"]["evaluations"][0]["version"] == "2.0.0"
    (since,) = document["since_last"]
    assert {"first", "second"} <= since["comparison"].keys()
    assert document.keys() | since.keys() | {"first", "second"} == json_documents()["evaluate"]
    assert (since["folder"], since["version"], since["comparison"]["pairs"]) == ("0001-mine", "1.0.0", 7)
    kept = sorted(path.name for path in (tmp_path / "out" / "evaluations").iterdir())
    assert kept == ["0001-mine", "0002-mine", "0003-mine"]


EDITS_ITSELF = """
    def reset(self, match):
        if os.path.exists("notes"):
            with open("agent.py", "a") as file:
                file.write("# better now")
        open("notes", "w").close()
"""


@pytest.mark.slow
def test_an_agent_that_is_edited_while_it_plays_is_not_mixed_with_its_former_self(
    submit: Submit, wildscav: Command, warm_workers: WarmWorkers, tmp_path: Path
) -> None:
    folder = submit("mine", EDITS_ITSELF + WALKER).folder
    agent, out, suite = folder / "agent.py", tmp_path / "out", tiny_suite(tmp_path, maps=2, seconds=2)
    before = agent.read_text()
    arguments = ("evaluate", folder, f"--suite={suite}", f"--out={out}", "--workers=1", "--replays=first")
    with playing_with(warm_workers):
        done = wildscav(*arguments)
        changed = wildscav(*arguments)
        agent.write_text(before)
        (folder / "notes").unlink()
        resumed = wildscav(*arguments)

    assert (done.returncode, changed.returncode, resumed.returncode) == (2, 2, 0)
    assert f"{agent} was changed while 'mine' was being played" in complaint(done)
    assert "another evaluation" in complaint(changed)
    assert "1 of 2 matches was played before" in resumed.stdout
    (one,) = read_results(out / "results.json").evaluations
    assert (len(one.matches), one.faults) == (2, 0)


def test_a_ledger_that_cannot_be_closed_keeps_no_results_from_being_shown(tmp_path: Path) -> None:
    results = results_of("ada")
    ledger = LedgerWriter(tmp_path, identity_of("ada"), None)
    ledger._path = Path("/dev/full")  # the disk is full from here on

    (said,) = saving_errors(results, tmp_path, ledger)

    assert said == "the ledger /dev/full cannot be written: No space left on device"
    assert read_results(tmp_path / "results.json") == results
