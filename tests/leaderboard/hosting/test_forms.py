"""Forms: none does anything unless our own page made it for whoever sends it."""

import sqlite3
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path

import httpx
import pytest
from tests.leaderboard.filled_season import COOKIE, PASSWORD, FilledSeason
from tests.leaderboard.hosting.clients import Site, copied_database, numbers_of
from tests.leaderboard.hosting.route_table import TABLE, Line

WITHOUT_SESSION = {"/login", "/register"}  # forms for those who are not logged in
FORMS = [line for line in TABLE if line.route.startswith("POST /") and line.is_page]
NAMED = {"name": "owls", "password": PASSWORD}


@pytest.fixture
def client(hostile_site: Site) -> httpx.Client:
    return hostile_site.client


@pytest.fixture
def copy(hostile_site: Site, tmp_path: Path) -> Iterator[Path]:
    with copied_database(hostile_site.app, hostile_site.filled, tmp_path) as path:
        yield path


def content(database: Path) -> list[str]:
    with closing(sqlite3.connect(database)) as connection:
        return list(connection.iterdump())


@pytest.mark.parametrize("sent", ["no token", "another person's token"])
@pytest.mark.parametrize(
    "line", [line for line in FORMS if line.path not in WITHOUT_SESSION], ids=lambda line: line.route
)
def test_a_form_without_the_token_of_its_session_changes_nothing(
    client: httpx.Client, hostile_season: FilledSeason, copy: Path, line: Line, sent: str
) -> None:
    person, other = hostile_season.people["organizer"], hostile_season.people["owner"]
    token = {} if sent == "no token" else {"csrf": other.csrf}
    body = {} if isinstance(line.body, str) else {**line.body, **token}
    headers = {"Cookie": f"{COOKIE}={person.cookie}", "X-CSRF": token.get("csrf", "")}
    before = content(copy)

    response = client.post(line.path.format(**numbers_of(hostile_season)), data=body, headers=headers)

    assert response.status_code in (403, 404, 422)  # 404: a table that there is not
    assert content(copy) == before


@pytest.mark.parametrize("path", sorted(WITHOUT_SESSION))
@pytest.mark.parametrize(
    ("headers", "status"),
    [
        ({"Origin": "https://evil.example"}, 403),
        ({"Origin": "null"}, 403),
        ({"Sec-Fetch-Site": "cross-site", "Origin": "https://evil.example"}, 403),
        ({"Sec-Fetch-Site": "same-site"}, 403),  # another host of the same domain
        ({"Sec-Fetch-Site": "same-origin"}, 303),
        ({}, 303),  # a program
    ],
)
def test_another_site_logs_nobody_in(
    client: httpx.Client, copy: Path, path: str, headers: dict[str, str], status: int
) -> None:
    fields = NAMED if path == "/login" else {**NAMED, "name": "somebody"}

    response = client.post(path, data=fields, headers=headers)

    assert response.status_code == status
    assert ("set-cookie" in response.headers) == (status == 303)


@pytest.mark.parametrize(
    ("following", "leads_to"),
    [
        ("/submissions/3?from=mail", "/submissions/3?from=mail"),
        ("//evil.example", "/account"),
        ("https://evil.example/", "/account"),
        ("/\\evil.example", "/account"),
        ("/%0d%0aSet-Cookie: a=b", "/account"),
        ("javascript:alert(1)", "/account"),
    ],
)
def test_logging_in_leads_to_a_page_of_our_own(
    client: httpx.Client, copy: Path, following: str, leads_to: str
) -> None:
    response = client.post("/login", data={**NAMED, "following": following})

    assert response.headers["location"] == leads_to


def test_the_page_that_was_asked_for_is_shown_after_logging_in(client: httpx.Client, copy: Path) -> None:
    refused = client.get("/organizer/audit-log")
    form = client.get(refused.headers["location"])

    assert 'name="following" value="/organizer/audit-log"' in form.text


def test_a_cookie_is_out_of_reach_of_scripts_and_of_other_sites(client: httpx.Client, copy: Path) -> None:
    cookie = client.post("/login", data=NAMED).headers["set-cookie"].lower()

    assert "httponly" in cookie
    assert "samesite=lax" in cookie


def test_whoever_logs_out_is_logged_out_on_the_server(
    client: httpx.Client, hostile_season: FilledSeason, copy: Path
) -> None:
    person = hostile_season.people["owner"]
    headers = {"Cookie": f"{COOKIE}={person.cookie}"}

    client.post("/logout", data={"csrf": person.csrf}, headers=headers)

    assert client.get("/account", headers=headers).status_code == 303
