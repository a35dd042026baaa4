"""`wildscav play` as its user runs it."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from tests.evaluator.sample_agents import TALKER, WALKER, Command, Submit

from wildscav_engine.record import read_record

pytestmark = pytest.mark.usefixtures("compiled")

SHORT = ("--size", 40, "--time-limit", 1)


def test_a_match_leaves_what_was_asked_for_and_no_more(
    wildscav: Command, submit: Submit, tmp_path: Path
) -> None:
    folder = submit("walker", WALKER).folder
    here = tmp_path / "here"
    here.mkdir()

    done = wildscav("play", folder, *SHORT, "--record", "a/match.wsr", "--replay", "b/match.rrd", cwd=here)

    assert done.returncode == 0, done.stderr
    assert read_record(here / "a" / "match.wsr").names == ("walker",)
    assert sorted(path.name for path in here.iterdir()) == ["a", "b"]


def test_what_agents_print_replaces_nothing_that_an_earlier_match_left(
    wildscav: Command, submit: Submit, tmp_path: Path
) -> None:
    there = ("0-talker.log", "0003-talker/0-talker.log", "0004-notes")
    earlier = [tmp_path / "out" / "play" / name for name in there]
    for log in earlier:
        log.parent.mkdir(parents=True, exist_ok=True)
        log.write_text("earlier")

    done = wildscav("play", submit("talker", TALKER).folder, *SHORT, "--json", cwd=tmp_path)

    assert "the agents' output is in out/play/0005-talker" in done.stderr
    assert json.loads(done.stdout)["logs"] == "out/play/0005-talker"
    assert (tmp_path / "out/play/0005-talker/0-talker.log").read_text().startswith("step 0")
    assert [log.read_text() for log in earlier] == ["earlier"] * 3


def test_where_no_folder_can_be_made_one_is_to_be_named(
    wildscav: Command, submit: Submit, tmp_path: Path
) -> None:
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "play").touch()

    done = wildscav("play", submit("walker", WALKER).folder, cwd=tmp_path)

    assert done.stderr == "wildscav: out/play is not a folder: name one with --logs\n"


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["--robots", "5000", "--track", "battle"], "here at most 999 robots"),
        (["--robots", "fightr", "--track", "battle"], "did you mean 'fighter' or 'fighter-hard'?"),
        (["--time-limit", "1e9"], "--time-limit"),
        pytest.param(["--time-limit", "nan"], "--time-limit", marks=pytest.mark.slow),
        pytest.param(["--record", "{folder}"], "is a folder: name a file in it", marks=pytest.mark.slow),
        (["--replay", "{folder}"], "is a folder: name a file in it"),
        (["--record", "/dev/null/match.wsr"], "--record /dev/null/match.wsr cannot be written: "),
        pytest.param(
            ["--replay", "/dev/null"], "--replay /dev/null is not a plain file", marks=pytest.mark.slow
        ),
        pytest.param(
            ["--record", "same", "--replay", "./same"],
            "--record and --replay name the same file",
            marks=pytest.mark.slow,
        ),
    ],
)
def test_what_cannot_be_played_or_written_is_refused_before_the_match(
    wildscav: Command, submit: Submit, tmp_path: Path, arguments: list[str], says: str
) -> None:
    walker = submit("walker", WALKER, tracks='["navigation", "battle"]').folder
    given = [argument.format(folder=tmp_path, walker=walker) for argument in arguments]

    done = wildscav("play", walker, "--logs", tmp_path / "logs", *given, cwd=tmp_path)

    assert done.returncode == 2, done.stderr
    assert "Traceback" not in done.stderr
    assert says in done.stderr
    assert not (tmp_path / "logs").exists()


@pytest.mark.slow
def test_an_interrupted_match_says_so(submit: Submit, tmp_path: Path) -> None:
    folder = submit("sleeper", "    def act(self, observation): print(1, flush=True); time.sleep(600)").folder
    logs = tmp_path / "logs"
    program = str(Path(sys.executable).parent / "wildscav")
    command = [program, "play", str(folder), "--logs", str(logs)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as playing:
        log = logs / "0-sleeper.log"
        while not (log.exists() and log.stat().st_size):
            assert playing.poll() is None
            time.sleep(0.05)
        os.kill(playing.pid, signal.SIGINT)
        _, errors = playing.communicate(timeout=120)

    assert playing.returncode == 130
    assert errors.splitlines()[-1].startswith("wildscav: interrupted")
    assert "Traceback" not in errors
