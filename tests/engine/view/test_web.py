"""A replay in a browser: what the server answers. A real one shows it by the same policy (leaderboard)."""

import re
import socket
import threading
from collections.abc import Iterator
from contextlib import closing
from email.message import Message
from http.client import HTTPConnection
from pathlib import Path
from typing import NamedTuple
from urllib.parse import parse_qs, urlsplit

import pytest

from wildscav_engine.view import ViewError
from wildscav_engine.view.web import ReplayServer


@pytest.fixture(scope="module")
def server(battle_file: Path) -> Iterator[ReplayServer]:
    with ReplayServer(battle_file.read_bytes()) as server:
        thread = threading.Thread(target=server.serve_forever)
        thread.start()
        yield server
        server.shutdown()
        thread.join()


class Answer(NamedTuple):
    status: int
    headers: Message
    body: bytes


def ask(server: ReplayServer, path: str, method: str = "GET", host: str | None = None) -> Answer:
    with closing(HTTPConnection("127.0.0.1", server.server_address[1])) as connection:
        connection.request(method, path, headers={} if host is None else {"Host": host})
        answer = connection.getresponse()
        return Answer(answer.status, answer.headers, answer.read())


@pytest.mark.slow
def test_the_link_leads_to_the_viewer_with_the_recording(server: ReplayServer, battle_file: Path) -> None:
    first = ask(server, "/")
    place = first.headers["Location"]
    recording = parse_qs(urlsplit(place).query)["url"][0]

    assert first.status == 302
    assert recording == f"{server.link}replay.rrd"
    assert b"re_viewer.js" in ask(server, place).body
    assert ask(server, urlsplit(recording).path).body == battle_file.read_bytes()


def test_the_viewer_is_that_of_the_installed_package(server: ReplayServer) -> None:
    assert ask(server, "/re_viewer_bg.wasm").body.startswith(b"\x00asm")
    assert ask(server, "/re_viewer_bg.wasm").headers["Content-Type"] == "application/wasm"
    assert b"wasm_bindgen" in ask(server, "/re_viewer.js").body


def test_no_page_may_ask_another_host(server: ReplayServer) -> None:
    for path in ("/", "/?url=x", "/re_viewer.js", "/none"):
        policy = ask(server, path).headers["Content-Security-Policy"]
        assert "connect-src 'self';" in policy
        assert re.search(r"https?:", policy) is None


def test_there_is_nothing_else(server: ReplayServer) -> None:
    assert [ask(server, path).status for path in ("/none", "/../etc/passwd", "/replay.rrd/x")] == [404] * 3
    assert ask(server, "/replay.rrd", "HEAD").body == b""
    assert ask(server, "/replay.rrd", "POST").status == 501


@pytest.mark.parametrize(
    ("host", "status"),
    [
        ("localhost:7010", 200),
        ("[::1]:7010", 200),
        (socket.gethostname().upper(), 200),
        ("evil.example", 400),  # whose owner can lead the name here
        ("evil/x?y", 400),
        ("", 400),
    ],
)
def test_it_answers_by_its_own_names_alone(server: ReplayServer, host: str, status: int) -> None:
    assert ask(server, "/replay.rrd", host=host).status == status


def test_it_listens_on_this_machine_alone(server: ReplayServer) -> None:
    assert server.server_address[0] == "127.0.0.1"


def test_a_port_that_is_taken_is_one_clear_error() -> None:
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = taken.getsockname()[1]
        with pytest.raises(ViewError, match=f"cannot listen on 127.0.0.1, port {port}: "):
            ReplayServer(b"", port=port)
