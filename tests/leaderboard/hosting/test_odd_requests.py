"""Requests as no page of ours sends them, how often pages ask the database, and readers that read nothing."""

import os
import re
import socket
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from urllib.parse import urlsplit

import httpx
import pytest
from sqlalchemy import event
from sqlalchemy.engine import Engine
from tests.leaderboard.hosting.clients import Site, serving
from tests.leaderboard.hosting.route_table import TABLE
from tests.leaderboard.seasons_made import changed, make_season, opened

from wildscav_leaderboard.visibility import path_of_record

HUGE = 10**23
MAX_QUERIES = 10  # queries of a page
MORE_IF_LOGGED_IN = 3  # who it is, of which team, and what that team alone sees
READERS = 100
LARGE = 16 << 20  # bytes, which the buffers of no connection hold


@pytest.fixture
def client(hostile_site: Site) -> httpx.Client:
    return hostile_site.client


@pytest.mark.parametrize("path", ["/", "/health", "/ready", "/boards/battle", "/api/v1/season", "/matches/7"])
def test_whoever_asks_for_the_head_of_an_answer_gets_it(client: httpx.Client, path: str) -> None:
    head, whole = client.head(path), client.get(path)

    assert (head.status_code, head.content) == (whole.status_code, b"")
    assert head.headers["Content-Type"] == whole.headers["Content-Type"]
    assert head.headers["Content-Length"] == str(len(whole.content))


def test_a_number_that_no_entry_can_have_breaks_nothing(client: httpx.Client) -> None:
    paths = {re.sub(r"\{\w+\}", str(HUGE), line.path) for line in TABLE if line.method == "GET"}
    answers = {path: client.get(path).status_code for path in paths if str(HUGE) in path}

    assert len(answers) > 10
    assert {path: status for path, status in answers.items() if status >= 500} == {}
    assert client.get(f"/matches/{HUGE}").status_code == client.get(f"/matches/-{HUGE}").status_code == 422


def test_whoever_asks_whether_the_season_is_ready_is_not_told_where_its_database_is(tmp_path: Path) -> None:
    lost = "postgresql+psycopg://keeper:pw@127.0.0.1:1/season"
    season = changed(make_season(tmp_path / "season", current=True), database=lost)
    with serving(season, season.database()) as (_, client):
        answer = client.get("/ready")

    assert answer.status_code == 503
    assert answer.json() == {"ready": False, "reason": "the database does not answer: try again in a moment"}


def test_a_browser_stays_logged_in_to_two_seasons_of_one_host(tmp_path: Path) -> None:
    with httpx.Client() as browser, ExitStack() as stack:
        sites = [stack.enter_context(registered(tmp_path / name, browser)) for name in ("spring", "autumn")]
        assert [browser.get(f"{site}/account").status_code for site in sites] == [200, 200]


@contextmanager
def registered(folder: Path, browser: httpx.Client) -> Iterator[httpx.URL]:
    """Serve a season in which a browser gets an account."""
    season = changed(make_season(folder, current=True), name=folder.name)
    with opened(season) as database, serving(season, database) as (_, client):
        form = {"name": "ada", "password": "correct horse battery", "again": "correct horse battery"}
        assert browser.post(client.base_url.join("/register"), data=form).status_code == 303
        yield client.base_url


@pytest.fixture
def asked() -> Iterator[list[str]]:
    """The queries that are sent to any database."""
    found: list[str] = []

    def note(_connection, _cursor, statement, *_others) -> None:
        if statement.lstrip().startswith("SELECT"):
            found.append(statement)

    event.listen(Engine, "before_cursor_execute", note)
    yield found
    event.remove(Engine, "before_cursor_execute", note)


@pytest.mark.parametrize("asker", ["visitor", "owner", "organizer"])
@pytest.mark.parametrize(
    "path",
    [
        *("/", "/boards/navigation", "/boards/battle", "/teams/owls"),
        *("/submissions/{active}", "/submissions/{queued}", "/matches", "/matches?track=battle&team=owls"),
        *("/matches/{suite}", "/matches/{ladder}", "/matches/{playing}"),
    ],
)
def test_a_page_asks_the_database_few_times(
    hostile_site: Site, asked: list[str], asker: str, path: str
) -> None:
    hostile_site.ask(asker, path)  # what is parsed once is kept
    allowed = MAX_QUERIES + (0 if asker == "visitor" else MORE_IF_LOGGED_IN)
    for _ in range(3):  # threads that look for news may ask something at the same moment
        asked.clear()
        assert hostile_site.ask(asker, path).status_code == 200
        if 0 < len(asked) <= allowed:
            return
    raise AssertionError("\n\n".join(asked))


@pytest.fixture
def large_record(hostile_site: Site) -> Iterator[int]:
    """The number of a public match whose record is large."""
    filled, match = hostile_site.filled, hostile_site.filled.matches["ladder"]
    with filled.database.reading() as session:
        path = path_of_record(session, filled.season, match)
    size = path.stat().st_size
    os.truncate(path, LARGE)
    yield match
    os.truncate(path, size)


def test_pages_are_answered_beside_readers_that_read_nothing(client: httpx.Client, large_record: int) -> None:
    with ExitStack() as stack:
        there = urlsplit(str(client.base_url))
        readers = []
        for _ in range(READERS):  # all at once, which are more than there are threads
            reader = stack.enter_context(socket.socket())
            reader.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
            reader.connect((there.hostname, there.port))
            reader.sendall(f"GET /api/v1/matches/{large_record}/record HTTP/1.1\r\nHost: a\r\n\r\n".encode())
            readers.append(reader)
        for path in ("/", "/boards/battle", "/api/v1/matches"):
            assert client.get(path, timeout=20.0).status_code == 200
        assert {reader.recv(12) for reader in readers} == {b"HTTP/1.1 200"}
