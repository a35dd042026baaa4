"""What a client says when it does not find a season, or is refused: one line, and never a traceback."""

import json
import socket
import socketserver
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from datetime import UTC, datetime
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any

import pytest
from tests.leaderboard.webhooks.receivers import running
from tests.platform.helpers.certificates import Authority, Pair

from wildscav.errors import UserError
from wildscav_leaderboard.api.documents import SubmissionView
from wildscav_leaderboard.competing import connection as connections
from wildscav_leaderboard.competing import season_client
from wildscav_leaderboard.competing.connection import AnswerError, Connection, NoSeasonError, UnreachableError
from wildscav_leaderboard.competing.season_client import SeasonClient

Answer = tuple[int, dict[str, str], bytes]


@contextmanager
def http_server(answer: Callable[[str], Answer], pair: Pair | None = None) -> Iterator[str]:
    """Run a server that answers by path, with TLS if there is a certificate; give its address."""

    class Handler(BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            status, headers, content = answer(self.path)
            self.send_response(status)
            for name, value in {"Content-Length": str(len(content)), **headers}.items():
                self.send_header(name, value)
            self.end_headers()
            self.wfile.write(content)

        def log_message(self, *_: Any) -> None:
            pass

    server = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
    server.handle_error = lambda *_: None  # type: ignore[method-assign] - a client that hangs up is no error
    with running(server, pair) as port:
        yield f"http{'' if pair is None else 's'}://127.0.0.1:{port}"


@contextmanager
def byte_server(content: bytes) -> Iterator[str]:
    """Run a server that says the same to everyone and hangs up; give its address."""

    class Handler(socketserver.BaseRequestHandler):
        def handle(self) -> None:
            self.request.recv(1 << 16)
            self.request.sendall(content)

    with running(socketserver.ThreadingTCPServer(("127.0.0.1", 0), Handler)) as port:
        yield f"http://127.0.0.1:{port}"


def refusal(url: str, token: str | None = None) -> UserError:
    """What is raised when a season is looked for at an address."""
    with pytest.raises(UserError) as caught, Connection(url, token) as connection:
        SeasonClient(connection).season()
    assert "\n" not in str(caught.value)
    return caught.value


def says(status: int, content: object, **headers: str) -> Answer:
    return status, headers, content if isinstance(content, bytes) else json.dumps(content).encode()


def test_where_nobody_listens_nothing_is_reached() -> None:
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        url = f"http://127.0.0.1:{taken.getsockname()[1]}"
        assert str(refusal(url)) == f"cannot reach {url}: Connection refused"


def test_a_name_that_does_not_exist_is_named() -> None:
    error = refusal("https://season.invalid")
    assert isinstance(error, UnreachableError)
    assert "cannot reach https://season.invalid: " in str(error)


@pytest.mark.parametrize(
    "content", [b"SSH-2.0-OpenSSH_9.9\r\n", b"", b"HTTP/1.1 200 OK\r\nContent-Length: 9\r\n\r\n{"]
)
def test_what_does_not_speak_http_to_the_end_is_no_answer(content: bytes) -> None:
    with byte_server(content) as url:
        error = refusal(url)
    assert isinstance(error, UnreachableError)
    assert "does not speak HTTP" in str(error) or "ended the connection" in str(error)


@pytest.mark.parametrize(
    ("answer", "told"),
    [
        (says(404, b"<h1>Not Found</h1>"), "{nowhere}: HTTP status 404"),
        (says(200, b"<h1>Welcome</h1>"), "{nowhere}: its answer is no document"),
        (says(200, b"[" * 100_000), "{nowhere}: its answer is no document"),
        (says(200, {"name": "another"}), "{url} does not answer as a season of Wildscav"),
        (says(200, []), "{url} does not answer as a season of Wildscav"),
        (says(500, [{"error": "?"}]), "{nowhere}: HTTP status 500"),
        (
            says(301, b"", Location="https://elsewhere.org/api?x=1"),
            "{url} redirects to https://elsewhere.org: log in there, if you trust it",
        ),
        (says(302, b"", Location="/login"), "{url} redirects: log in there, if you trust it"),
    ],
)
def test_other_web_servers_are_no_seasons(answer: Answer, told: str) -> None:
    with http_server(lambda _: answer) as url:
        error = refusal(url)
    assert isinstance(error, NoSeasonError)
    assert str(error).startswith(told.format(url=url, nowhere=f"there is no season of Wildscav at {url}"))


def test_a_refusal_is_told_in_the_seasons_words_and_not_at_any_length() -> None:
    with http_server(lambda _: says(403, {"error": "only " + "x" * 9000, "status": 403})) as url:
        error = refusal(url)
    assert isinstance(error, AnswerError)
    assert (error.status, error.is_passing) == (403, False)
    assert str(error).startswith("only xxx")
    assert len(str(error)) < 1000


def test_a_season_that_is_down_behind_its_proxy_may_come_back() -> None:
    with http_server(lambda _: says(502, b"<h1>Bad Gateway</h1>")) as url:
        error = refusal(url)
    assert isinstance(error, AnswerError)
    assert error.is_passing
    assert str(error) == f"the season at {url} is down: HTTP status 502"


def test_an_answer_without_end_is_not_read_to_its_end(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(connections, "LARGEST_ANSWER", 1 << 20)
    with http_server(lambda _: says(200, b"[" + b" " * (4 << 20) + b"]")) as url:
        assert "the answer has more than 1 MiB" in str(refusal(url))


def test_certificates_are_checked(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    authority = Authority(tmp_path, "organizers")
    with http_server(lambda _: says(403, {"error": "refused"}), authority.sign("season")) as url:
        stranger = refusal(url)
        assert f"the certificate of {url} is not trusted" in str(stranger)
        assert "SSL_CERT_FILE" in str(stranger)
        # The token would be lost if it had been sent, so a failed check must be the end.
        assert not isinstance(stranger, AnswerError)

        monkeypatch.setenv("SSL_CERT_FILE", str(authority.path))
        assert str(refusal(url)) == "refused"


def test_https_to_a_server_without_tls_suggests_http() -> None:
    with http_server(lambda _: says(200, {})) as url:
        error = refusal(url.replace("http://", "https://"))
    assert "does not speak TLS" in str(error)
    assert "http://" in str(error)


@pytest.mark.parametrize("token", ["", "two words", "wildscav_é", "line\nbreak"])
def test_what_cannot_be_a_token_is_not_sent(token: str) -> None:
    with pytest.raises(UserError, match="this is not a token"):
        Connection("http://127.0.0.1:1", token)


NOON = datetime(2030, 6, 1, 12, tzinfo=UTC)
FIRST = SubmissionView(
    id=7,
    team="ants",
    team_title="The Ants",
    name="walker",
    version="1",
    message="",
    tracks=["battle"],
    digest="ab" * 16,
    size=1,
    created=NOON,
    state="submitted",
    since=NOON,
    playing=[],
    kept=False,
    deadline=None,
    charged=True,
    platform_faults=0,
    fault=None,
)


def state(name: str) -> Answer:
    return 200, {}, FIRST.model_copy(update={"state": name}).model_dump_json().encode()


DOWN: Answer = (502, {}, b"<h1>Bad Gateway</h1>")
LATER: Answer = (429, {}, json.dumps({"error": "too many requests: try again in 1 s"}).encode())


@pytest.fixture(autouse=True)
def quick(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(season_client, "PAUSE", 0.0)


def followed(*answers: Answer) -> Iterator[Any]:
    """What is seen of a submission whose season answers like this."""
    left = list(answers)
    with http_server(lambda _: left.pop(0)) as url, Connection(url, "token") as connection:
        for seen in season_client.follow(SeasonClient(connection), FIRST):
            yield seen.state if isinstance(seen, SubmissionView) else "?"


@pytest.mark.parametrize("last", ["active", "failed", "cancelled", "disabled"])
def test_it_ends_with_the_submission(last: str) -> None:
    assert list(followed(state("queued"), state(last))) == ["submitted", "queued", last]


def test_a_season_that_is_down_or_busy_is_asked_again() -> None:
    seen = list(followed(DOWN, LATER, state("building"), DOWN, state("active")))
    assert seen == ["submitted", "?", "?", "building", "?", "active"]


def test_a_season_that_stays_away_is_given_up(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(season_client, "PATIENCE", 0.0)
    with pytest.raises(UserError, match="is down: HTTP status 502"):
        list(followed(DOWN))


def test_a_refusal_is_the_end() -> None:
    refused = (401, {}, json.dumps({"error": "this token is unknown or revoked"}).encode())
    with pytest.raises(UserError, match="this token is unknown or revoked"):
        list(followed(state("queued"), refused))
