"""How often one may ask, how often a password may be tried, and how much one may send."""

import asyncio
import threading
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple

import httpx
import pytest
from fastapi import FastAPI
from tests.leaderboard.filled_season import PASSWORD
from tests.leaderboard.hosting.clients import serving
from tests.leaderboard.seasons_made import NOON, changed, make_season, opened

from wildscav_leaderboard.access import logins, uploads
from wildscav_leaderboard.access.rate_limits import AddressCounts
from wildscav_leaderboard.accounts.passwords import hashed
from wildscav_leaderboard.accounts.service import add_account, new_token
from wildscav_leaderboard.seasons.folder import Season
from wildscav_leaderboard.seasons.refusals import InvalidError
from wildscav_leaderboard.seasons.settings import Quotas
from wildscav_leaderboard.teams.service import make_team

PIECE = bytes(64 << 10)


WRONG, RIGHT = ({"name": "owls", "password": password} for password in ("a wrong password", PASSWORD))


class Arena(NamedTuple):
    """A served season with one team, and its member's token."""

    season: Season
    client: httpx.Client
    token: str
    app: FastAPI

    def upload(self, body: Iterator[bytes]) -> httpx.Response:
        headers = {"Authorization": f"Bearer {self.token}"}
        return self.client.post("/api/v1/submissions", content=body, headers=headers)


@pytest.fixture
def arena(tmp_path: Path, request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> Iterator[Arena]:
    monkeypatch.setattr(logins, "LONGEST_PAUSE", 0.0)
    more = f"[web]\nrequests_per_minute = {getattr(request, 'param', 1000)}\n"
    season = changed(make_season(tmp_path / "season", more, current=True), quotas=Quotas(archive=1))
    with opened(season) as database:
        with database.writing() as session:
            account = add_account(session, "owls", hashed(PASSWORD), "competitor", NOON)
            make_team(session, account, "owls", "", NOON)
            token = new_token(session, account, "test", NOON)
        with serving(season, database) as (app, client):
            yield Arena(season, client, token, app)


def pieces(count: int, sent: list[int]) -> Iterator[bytes]:
    for number in range(count):
        sent.append(number)
        yield PIECE


@pytest.mark.parametrize("path", ["/login", "/api/v1/tokens"])
def test_passwords_cannot_be_guessed_by_trying(arena: Arena, path: str) -> None:
    kind = "json" if path.startswith("/api") else "data"
    assert [arena.client.post(path, **{kind: WRONG}).status_code for _ in range(10)] == [401] * 10
    refused = arena.client.post(path, **{kind: RIGHT})
    assert (refused.status_code, "too often: try again in" in refused.text) == (429, True)


def test_the_page_and_the_api_count_passwords_together(arena: Arena) -> None:
    for _ in range(5):
        arena.client.post("/login", data=WRONG)
        arena.client.post("/api/v1/tokens", json=WRONG)

    assert arena.client.post("/login", data=WRONG).status_code == 429


def test_web_servers_of_one_season_count_together(arena: Arena) -> None:
    with opened(arena.season) as other, serving(arena.season, other) as (_, second):
        for _ in range(5):
            arena.client.post("/login", data=WRONG)
            second.post("/login", data=WRONG)
        assert second.post("/login", data=WRONG).status_code == 429


def tried(arena: Arena, address: str, body: dict[str, str] = RIGHT) -> int:
    """Try a password from an address; return the status."""
    headers = {"X-Forwarded-For": address}
    return arena.client.post("/api/v1/tokens", json=body, headers=headers).status_code


def test_nobody_is_locked_out_by_wrong_tries_of_others(arena: Arena) -> None:
    assert {tried(arena, f"192.0.2.{number}", WRONG) for number in range(15)} == {401}
    assert tried(arena, "198.51.100.1") == 201


def test_a_network_of_version_6_counts_as_one_address(arena: Arena) -> None:
    wrong = [tried(arena, f"2001:db8:0:1::{number:x}", WRONG) for number in range(11)]
    assert wrong == [401] * 10 + [429]
    assert tried(arena, "2001:db8:0:2::1") == 201


def test_whoever_knows_the_password_may_log_in_often(arena: Arena) -> None:
    assert [tried(arena, "192.0.2.1") for _ in range(12)] == [201] * 12


def test_a_name_answers_more_slowly_with_every_try() -> None:
    pauses = [logins.pause(tries) for tries in range(12)]
    assert pauses == [0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 2.0, 4.0, 8.0, 8.0, 8.0, 8.0]


def test_accounts_cannot_be_made_by_the_hundred(arena: Arena) -> None:
    def register(number: int) -> int:
        new = {"name": f"account-{number}", "password": PASSWORD}
        return arena.client.post("/api/v1/accounts", json=new).status_code

    assert [register(number) for number in range(11)] == [201] * 10 + [429]


@pytest.mark.parametrize("arena", [5], indirect=True)
def test_an_address_that_asks_too_often_is_told_when_to_come_back(arena: Arena) -> None:
    answers = [arena.client.get("/health") for _ in range(11)]  # more than two minutes allow
    refused = next(answer for answer in answers if answer.status_code != 200)

    assert [answer.status_code for answer in answers[:5]] == [200] * 5
    assert refused.status_code == 429
    assert 1 <= int(refused.headers["retry-after"]) <= 60
    assert "content-security-policy" in refused.headers


def test_an_archive_that_is_too_large_is_not_read_to_its_end_and_leaves_no_file(arena: Arena) -> None:
    sent: list[int] = []
    try:
        response = arena.upload(pieces(4000, sent))
        assert response.status_code == 413
        assert "larger than 1 MiB" in response.text
    except httpx.TransportError:
        pass  # the server closed the connection while the client was still sending
    assert len(sent) < 4000
    assert [path for path in arena.season.files.rglob("*") if path.is_file()] == []


def test_an_archive_that_is_no_archive_leaves_no_file(arena: Arena) -> None:
    response = arena.upload(pieces(3, []))

    assert response.status_code == 422
    assert [path for path in arena.season.files.rglob("*") if path.is_file()] == []


@contextmanager
def uploading(arena: Arena, count: int) -> Iterator[None]:
    """Have several uploads in progress, whose archives arrive at the end of the block."""
    arrives = threading.Event()

    def body() -> Iterator[bytes]:
        yield PIECE
        arrives.wait(30.0)

    with ThreadPoolExecutor(count) as pool:
        sent = [pool.submit(arena.upload, body()) for _ in range(count)]
        try:
            while len(list(arena.season.files.glob("upload-*"))) < count:
                assert not any(one.done() for one in sent)
                time.sleep(0.01)
            yield
        finally:
            arrives.set()
    assert {one.result().status_code for one in sent} == {422}  # it is no archive


def test_pages_are_shown_however_many_uploads_are_in_progress(arena: Arena) -> None:
    arena.app.state.readers = asyncio.Semaphore(1)  # that may read at a time
    with uploading(arena, 2):
        assert arena.client.get("/", timeout=20.0).status_code == 200


def test_an_account_uploads_three_submissions_at_once(arena: Arena) -> None:
    with uploading(arena, 3):
        refused = arena.upload(pieces(1, []))
        assert (refused.status_code, "uploading 3 submissions already" in refused.text) == (429, True)
    assert arena.upload(pieces(1, [])).status_code == 422


def test_four_archives_are_checked_at_a_time_so_that_pages_have_threads(
    arena: Arena, monkeypatch: pytest.MonkeyPatch
) -> None:
    running, most = [], []

    def check(*_: object) -> None:
        running.append(1)
        most.append(len(running))
        time.sleep(0.2)
        running.pop()
        raise InvalidError("it is no archive")

    monkeypatch.setattr(uploads, "check_archive", check)
    monkeypatch.setattr(uploads, "AT_ONCE", 6)
    with uploading(arena, 6):
        pass
    assert max(most) == 4


@pytest.mark.parametrize("is_announced", [True, False])
@pytest.mark.parametrize("path", ["/login", "/api/v1/tokens"])
def test_a_form_or_document_that_is_too_large_is_refused(arena: Arena, path: str, is_announced: bool) -> None:
    kind = "application/json" if path.startswith("/api") else "application/x-www-form-urlencoded"
    content = PIECE * 100 if is_announced else pieces(100, [])
    try:
        response = arena.client.post(path, content=content, headers={"Content-Type": kind})
        assert response.status_code in (400, 413)
    except httpx.TransportError:
        pass  # the server closed the connection while the client was still sending
    assert arena.client.get("/health").status_code == 200


FIRST = "192.0.2.1"


def used(counts: AddressCounts, moment: float, times: int) -> int:
    """Count requests at one moment; return how long the last one has to wait."""
    return [counts.use(FIRST, moment) for _ in range(times)][-1]


def test_requests_of_the_minute_before_count_in_part() -> None:
    counts = AddressCounts(10)
    assert used(counts, 600.0, 10) == 0
    assert used(counts, 660.0, 1) > 0  # all ten count
    assert used(counts, 690.0, 5) == 0  # five of them do
    assert used(counts, 690.0, 1) > 0


def test_whoever_waits_as_long_as_told_is_let_in() -> None:
    counts = AddressCounts(7)
    for start in (600.0, 613.0, 659.5):
        moment = start + 300.0
        assert used(counts, moment, 7) == 0
        wait = used(counts, moment, 1)
        assert counts.use(FIRST, moment + wait) == 0


def test_addresses_are_counted_apart_and_forgotten_after_two_minutes() -> None:
    counts = AddressCounts(1)
    assert counts.use(FIRST, 600.0) == 0
    assert counts.use("192.0.2.2", 600.0) == 0
    assert counts.use(FIRST, 600.0) > 0
    assert counts.use(FIRST, 720.0) == 0
