"""How often one may ask, how often a password may be tried, and how much one may send."""

from collections.abc import Iterator
from pathlib import Path

import httpx
import pytest
from tests.leaderboard.filled_season import PASSWORD
from tests.leaderboard.seasons_made import NOON, make_season
from tests.leaderboard.spectating.served import served

from wildscav_leaderboard.accounts.passwords import hashed
from wildscav_leaderboard.accounts.service import add_account, new_token
from wildscav_leaderboard.hosting.app import create_app
from wildscav_leaderboard.teams.service import make_team

ARCHIVE = "[quotas]\nper_day = 3\nactive = 2\narchive = 1"  # MiB
PIECE = bytes(64 << 10)


class Arena:
    """A served season with one team, and its member's token."""

    def __init__(self, folder: Path, client: httpx.Client, token: str) -> None:
        self.files, self.client, self.token = folder / "season" / "files", client, token


@pytest.fixture
def arena(tmp_path: Path, request: pytest.FixtureRequest) -> Iterator[Arena]:
    more = f"[web]\nrequests_per_minute = {getattr(request, 'param', 1000)}\n"
    season = make_season(tmp_path / "season", more, current=True)
    settings = season.settings.model_copy(
        update={"quotas": season.settings.quotas.model_copy(update={"archive": 1})}
    )
    season = type(season)(season.folder, settings)
    database = season.database()
    database.upgrade()
    with database.writing() as session:
        account = add_account(session, "owls", hashed(PASSWORD), "competitor", NOON)
        make_team(session, account, "owls", "", NOON)
        token = new_token(session, account, "test", NOON)
    app = create_app(season, database)
    with served(app) as address, httpx.Client(base_url=address, timeout=60.0) as client:
        yield Arena(tmp_path, client, token)
    database.close()


def pieces(count: int, sent: list[int]) -> Iterator[bytes]:
    for number in range(count):
        sent.append(number)
        yield PIECE


@pytest.mark.parametrize("path", ["/login", "/api/v1/tokens"])
def test_passwords_cannot_be_guessed_by_trying(arena: Arena, path: str) -> None:
    wrong = {"name": "owls", "password": "a wrong password"}
    kind = "json" if path.startswith("/api") else "data"
    statuses = [arena.client.post(path, **{kind: wrong}).status_code for _ in range(10)]
    assert statuses == [401] * 10

    right = arena.client.post(path, **{kind: {"name": "owls", "password": PASSWORD}})

    assert right.status_code == 429
    assert "too often: try again in" in right.text


def test_the_page_and_the_api_count_passwords_together(arena: Arena) -> None:
    wrong = {"name": "owls", "password": "a wrong password"}
    for _ in range(5):
        arena.client.post("/login", data=wrong)
        arena.client.post("/api/v1/tokens", json=wrong)

    assert arena.client.post("/login", data=wrong).status_code == 429


def test_accounts_cannot_be_made_by_the_hundred(arena: Arena) -> None:
    def register(number: int) -> int:
        new = {"name": f"account-{number}", "password": PASSWORD}
        return arena.client.post("/api/v1/accounts", json=new).status_code

    assert [register(number) for number in range(11)] == [201] * 10 + [429]


@pytest.mark.parametrize("arena", [5], indirect=True)
def test_an_address_that_asks_too_often_is_told_when_to_come_back(arena: Arena) -> None:
    statuses = [arena.client.get("/health").status_code for _ in range(5)]
    refused = arena.client.get("/")

    assert statuses == [200] * 5
    assert refused.status_code == 429
    assert 1 <= int(refused.headers["retry-after"]) <= 60
    assert "content-security-policy" in refused.headers


def test_an_archive_that_is_too_large_is_not_read_to_its_end_and_leaves_no_file(arena: Arena) -> None:
    sent: list[int] = []
    headers = {"Authorization": f"Bearer {arena.token}"}
    try:
        response = arena.client.post("/api/v1/submissions", content=pieces(4000, sent), headers=headers)
        assert response.status_code == 413
        assert "larger than 1 MiB" in response.text
    except httpx.TransportError:
        pass  # the server closed the connection while the client was still sending
    assert len(sent) < 4000
    assert [path for path in arena.files.rglob("*") if path.is_file()] == []


def test_an_archive_that_is_no_archive_leaves_no_file(arena: Arena) -> None:
    headers = {"Authorization": f"Bearer {arena.token}"}

    response = arena.client.post("/api/v1/submissions", content=pieces(3, []), headers=headers)

    assert response.status_code == 422
    assert [path for path in arena.files.rglob("*") if path.is_file()] == []


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
