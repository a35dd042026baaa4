"""The program that the client starts, and what ``wildscav-legacy install`` writes and refuses."""

import logging
import os
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path

import pytest
from tests.commands import run_command
from tests.platform.legacy.helpers.commands import command
from tests.platform.legacy.helpers.competitor import Competitor

from wildscav.errors import UserError
from wildscav_legacy.commands import DEFAULT_MAPS, read_ids
from wildscav_legacy.install import install_engine, missing_maps, paths_of, write_map
from wildscav_legacy.program import ClientStderrHandler, read_address

Start = Callable[[int], subprocess.Popen[str]]


@pytest.fixture(scope="module")
def program(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return install_engine(tmp_path_factory.mktemp("a folder") / "engine")


@pytest.fixture
def start(program: Path) -> Iterator[Start]:
    """Start the program on a port, as the client does."""
    started: list[subprocess.Popen[str]] = []

    def start(port: int) -> subprocess.Popen[str]:
        arguments = [program, "-IP:127.0.0.1", f"-PORT:{port}"]
        started.append(subprocess.Popen(arguments, stderr=subprocess.PIPE, text=True))
        return started[-1]

    yield start
    for process in started:
        process.kill()
        process.communicate()


@pytest.mark.parametrize(
    ("arguments", "address"),
    [
        (["-IP:127.0.0.1", "-PORT:50051"], "127.0.0.1:50051"),
        (["-PORT:1", "-IP:game.example.org"], "game.example.org:1"),
        (["-IP:::1", "-PORT:9"], "[::1]:9"),
        (["-PORT:9"], "127.0.0.1:9"),
    ],
)
def test_the_client_names_its_address(arguments: list[str], address: str) -> None:
    assert read_address(arguments) == address


@pytest.mark.parametrize(
    ("arguments", "why"),
    [
        ([], "no port is given"),
        (["-IP:127.0.0.1"], "no port is given"),
        (["-PORT:0"], "-PORT:0 is not understood"),
        (["-PORT:70000"], "-PORT:70000 is not understood"),
        (["-PORT:x"], "-PORT:x is not understood"),
        (["-PORT:5", "--log-file"], "--log-file is not understood"),
    ],
)
def test_other_arguments_are_refused(arguments: list[str], why: str) -> None:
    with pytest.raises(UserError, match=why):
        read_address(arguments)


@pytest.mark.slow
def test_a_client_that_dies_ends_the_engine(start: Start) -> None:
    competitor = Competitor()
    process = start(competitor.port)
    competitor.wait()
    competitor.begin(command())
    competitor.die()
    _, said = process.communicate(timeout=120)
    assert process.returncode == 1
    assert f"the client on 127.0.0.1:{competitor.port} has gone" in said.splitlines()[-1]


@pytest.fixture
def interrupts() -> Iterator[list[int]]:
    """Count interrupts, which would end these tests: here they are the client's process."""
    counted: list[int] = []
    before = signal.signal(signal.SIGINT, lambda number, _: counted.append(number))
    yield counted
    signal.signal(signal.SIGINT, before)


def test_a_refused_field_is_a_clear_line_for_the_user_whose_client_stops_waiting(
    start: Start, interrupts: list[int], capfd: pytest.CaptureFixture[str]
) -> None:
    competitor = Competitor()
    process = start(competitor.port)
    competitor.wait()
    competitor.reply(1, gm_cmd=command(map_id=1000))
    _, said = process.communicate(timeout=120)
    assert process.returncode == 2
    assert said.splitlines()[-1].endswith("ERROR map_id is 1000, must be 1 to 999")
    assert "Traceback" not in said
    # The client may well keep the engine's words in no file: its own stderr has them, too.
    assert capfd.readouterr().err.splitlines() == ["wildscav: error: map_id is 1000, must be 1 to 999"]
    assert interrupts == [signal.SIGINT]
    competitor.die()


def test_a_client_is_told_each_warning_once(capfd: pytest.CaptureFixture[str]) -> None:
    log = logging.Logger("wildscav_legacy")
    log.addHandler(ClientStderrHandler(os.getpid()))
    for text in ("1 is used", "1 is used", "2 is used"):
        log.warning("%s", text)
    assert capfd.readouterr().err == "wildscav: warning: 1 is used\nwildscav: warning: 2 is used\n"


def test_only_a_parent_that_listens_on_the_port_is_the_client() -> None:
    code = (
        "import sys\nfrom wildscav_legacy.program import find_client\nprint(find_client(int(sys.argv[1])))\n"
    )
    competitor = Competitor()
    for port, found in ((competitor.port, str(os.getpid())), (1, "None")):
        said = subprocess.run([sys.executable, "-c", code, str(port)], capture_output=True, text=True).stdout
        assert said.strip() == found
    competitor.die()


@pytest.mark.parametrize(
    ("text", "ids"),
    [
        ("7", [7]),
        ("1,2,101-103", [1, 2, 101, 102, 103]),
        (" 5 , 3-4,4", [3, 4, 5]),
        ("014", [14]),
    ],
)
def test_maps_are_named_by_ids_and_ranges(text: str, ids: list[int]) -> None:
    assert read_ids(text) == ids


def test_the_default_are_60_maps() -> None:
    assert read_ids(DEFAULT_MAPS) == [*range(1, 21), *range(91, 131)]


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("", "--maps has '', must be ids and ranges such as 1,2,101-130"),
        ("1,,2", "--maps has ''"),
        ("a", "--maps has 'a'"),
        ("1-", "--maps has '1-'"),
        ("-5", "--maps has '-5'"),
        ("5-3", "--maps has '5-3', must be within 1 to 999 and ascending"),
        ("0", "--maps has '0', must be within 1 to 999"),
        ("1000", "--maps has '1000', must be within 1 to 999"),
    ],
)
def test_other_lists_are_refused(text: str, why: str) -> None:
    with pytest.raises(UserError, match=why) as refused:
        read_ids(text)
    assert refused.value.exit_code == 2


def test_the_program_can_be_run_from_anywhere_whatever_stands_in_pythonpath(tmp_path: Path) -> None:
    program = install_engine(tmp_path / "it's a folder" / "engine")
    (tmp_path / "wildscav.py").write_text("raise RuntimeError('not this one')\n")
    done = subprocess.run(
        [program], cwd=tmp_path, env={"PYTHONPATH": str(tmp_path)}, capture_output=True, text=True
    )
    assert done.returncode == 2
    assert "no port is given" in done.stderr


def test_only_what_is_missing_is_made(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    maps = tmp_path / "w" / "maps"
    maps.mkdir(parents=True)
    write_map(103, maps)
    written = paths_of(103, maps)[0].stat().st_mtime_ns
    wildscav = partial(run_command, "legacy", cwd=tmp_path, columns=200)
    done = wildscav("install", "w", "--maps", "103")
    assert done.returncode == 0, done.stderr
    assert "0 maps made, 1 there already" in done.stdout
    assert 'engine_dir="' in done.stdout
    assert paths_of(103, maps)[0].stat().st_mtime_ns == written
    assert (tmp_path / "w" / "engine" / "fps.x86_64").stat().st_mode & 0o111
    assert missing_maps([103, 104], maps) == [104]


def test_a_folder_that_cannot_be_is_one_line(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    wildscav = partial(run_command, "legacy", cwd=tmp_path, columns=200)
    done = wildscav("install", "file", "--maps", "103")
    assert done.returncode == 1
    renamed, error = done.stderr.splitlines()
    assert renamed.startswith("wildscav: `wildscav legacy` is called `wildscav-legacy` now")
    assert error.startswith("wildscav: file")
