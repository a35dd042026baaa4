"""``wildscav replay --web``: serves a replay until it is told to stop."""

import signal
from contextlib import closing
from functools import partial
from http.client import HTTPConnection
from pathlib import Path
from urllib.parse import urlsplit

import pytest
from tests.commands import Run, run_command, running

LINK = r"(http://\S+/)"
END = 120  # s, far more than it takes


@pytest.fixture
def replay(tmp_path: Path) -> Run:
    return partial(run_command, "replay", cwd=tmp_path, columns=200)


def recording_at(link: str) -> bytes:
    """What is served as the recording."""
    with closing(HTTPConnection(urlsplit(link).netloc)) as connection:
        connection.request("GET", "/replay.rrd")
        return connection.getresponse().read()


@pytest.mark.slow
def test_a_record_is_rendered_and_served_until_ctrl_c(record: Path) -> None:
    with running("replay", record, "--web", until=LINK) as (link, process):
        assert link.startswith("http://127.0.0.1:")
        assert recording_at(link).startswith(b"RRF")
        process.send_signal(signal.SIGINT)
        assert process.wait(END) == 0

    assert [path.name for path in record.parent.iterdir()] == [record.name]


def test_a_rendered_replay_is_served_as_it_is(record: Path, tmp_path: Path, replay: Run) -> None:
    path = tmp_path / "match.rrd"
    assert replay(record, "-o", path, "--no-images").returncode == 0

    with running("replay", path, "--web", "--host", "localhost", until=LINK) as (link, _):
        assert recording_at(link) == path.read_bytes()


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["--port", "8000"], "--host and --port are for --web: add --web"),
        (["--web", "--host", "no.such.host.invalid"], "cannot listen on no.such.host.invalid, port 0: "),
    ],
)
def test_what_cannot_be_served_is_one_clear_error(
    record: Path, replay: Run, options: list[str], said: str
) -> None:
    done = replay(record, *options)

    assert done.returncode != 0
    assert said in " ".join(done.stderr.split())
    assert "Traceback" not in done.stderr


def test_options_of_rendering_are_refused_for_a_replay(tmp_path: Path, replay: Run) -> None:
    (tmp_path / "match.rrd").write_bytes(b"RRF2")

    done = replay(tmp_path / "match.rrd", "--web", "--seat", "0")

    assert done.returncode == 2
    assert "--seat needs a record: this is a replay already" in " ".join(done.stderr.split())
