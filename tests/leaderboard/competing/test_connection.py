"""What a client says when it does not find a season, or is refused: one line, and never a traceback."""

import json
import socket
from pathlib import Path

import pytest
from tests.leaderboard.competing.strange_servers import Answer, byte_server, http_server
from tests.platform.helpers.certificates import Authority

from wildscav.errors import UserError
from wildscav_leaderboard.competing import connection as connections
from wildscav_leaderboard.competing.connection import AnswerError, Connection, NoSeasonError, UnreachableError
from wildscav_leaderboard.competing.season_client import SeasonClient


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
        (
            says(200, b"<h1>Welcome</h1>"),
            "{nowhere}: its answer is no document",
        ),
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
