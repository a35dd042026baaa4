"""``wildscav human`` from the shell."""

import signal
import socket
import subprocess
import sys
from pathlib import Path
from urllib.request import ProxyHandler, build_opener

import pytest
from tests.commands import run_command

from wildscav.errors import UserError
from wildscav_stage.playing.human import Serving

COMMAND = (sys.executable, "-m", "wildscav.cli.main", "human", "--no-browser")


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (("--track", "chess"), "--track is 'chess'; the tracks are navigation,"),
        (("--opponents", "nobody"), "--opponents has 'nobody', which is neither a robot"),
        (("--range", "--people", "2"), "--range has a map and targets of its own, for one person"),
        (("--name", "ann"), "--name and --fresh are for the matches of a --suite"),
        (("--fresh",), "--name and --fresh are for the matches of a --suite"),
        (("--suite", "reading", "--people", "2"), "--suite says what is played, by one person against its"),
        (("--suite", "reading", "--rules", "fair"), "--suite says what is played, by one person against its"),
    ],
)
def test_what_is_not_possible_is_one_line(options: tuple[str, ...], message: str) -> None:
    done = run_command("human", "--no-browser", *options)
    assert done.returncode == 2
    assert done.stderr.startswith(f"wildscav: {message}")
    assert done.stderr.count("\n") == 1


def test_a_port_that_is_taken_is_said_before_anything_is_compiled() -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken, pytest.raises(UserError, match="cannot be used"):
        Serving(port=taken.getsockname()[1]).checked()


@pytest.mark.slow
def test_it_serves_the_page_until_it_is_interrupted(tmp_path: Path) -> None:
    command = [*COMMAND, "--track", "navigation", "--records", str(tmp_path)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as game:
        assert game.stdout is not None
        link = next(line for line in game.stdout if line.startswith("play at ")).split()[-1]
        with build_opener(ProxyHandler({})).open(link) as page:
            assert b"<title>Wildscav</title>" in page.read()
        game.send_signal(signal.SIGINT)
        _, errors = game.communicate(timeout=60)
    assert game.returncode == 0
    assert "Traceback" not in errors
