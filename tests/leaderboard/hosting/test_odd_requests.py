"""Requests that no page of ours sends: for heads, for impossible numbers, and of programs that watch."""

import re
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

import httpx
import pytest
from tests.leaderboard.hosting.route_table import TABLE
from tests.leaderboard.seasons_made import make_season
from tests.leaderboard.spectating.served import served

from wildscav_leaderboard.hosting.app import create_app

HUGE = 10**23


@pytest.fixture(scope="module")
def client(tmp_path_factory: pytest.TempPathFactory) -> Iterator[httpx.Client]:
    season = make_season(tmp_path_factory.mktemp("odd") / "season", current=True)
    database = season.database()
    database.upgrade()
    with served(create_app(season, database)) as address, httpx.Client(base_url=address) as client:
        yield client
    database.close()


@pytest.mark.parametrize("path", ["/", "/health", "/ready", "/boards/battle", "/api/v1/season", "/matches/7"])
def test_whoever_asks_for_the_head_of_an_answer_gets_it(client: httpx.Client, path: str) -> None:
    head, whole = client.head(path), client.get(path)
    assert (head.status_code, head.content) == (whole.status_code, b"")
    assert head.headers["Content-Type"] == whole.headers["Content-Type"]
    assert head.headers["Content-Length"] == str(len(whole.content))


def test_a_number_that_no_entry_can_have_breaks_nothing(client: httpx.Client) -> None:
    paths = {re.sub(r"\{\w+\}", str(HUGE), line.path) for line in TABLE if line.method == "GET"}
    asked = sorted(path for path in paths if str(HUGE) in path)
    answers = {path: client.get(path).status_code for path in asked}
    assert len(asked) > 10
    assert {path: status for path, status in answers.items() if status >= 500} == {}
    assert client.get(f"/matches/{HUGE}").status_code == client.get(f"/matches/-{HUGE}").status_code == 422


def test_whoever_asks_whether_the_season_is_ready_is_not_told_where_its_database_is(tmp_path: Path) -> None:
    lost = "postgresql+psycopg://keeper:pw@127.0.0.1:1/season"
    season = make_season(tmp_path / "season", current=True)
    settings = season.settings.model_copy(update={"database": lost})
    season = type(season)(season.folder, settings)
    with served(create_app(season, season.database())) as address:
        answer = httpx.get(f"{address}/ready")
    assert answer.status_code == 503
    assert answer.json() == {
        "ready": False,
        "reason": "the database does not answer: try again in a moment",
    }


def test_a_browser_stays_logged_in_to_two_seasons_of_one_host(tmp_path: Path) -> None:
    with httpx.Client() as browser, ExitStack() as stack:
        spring = stack.enter_context(registered(tmp_path / "spring", "spring", browser))
        autumn = stack.enter_context(registered(tmp_path / "autumn", "autumn", browser))
        assert [browser.get(f"{site}/account").status_code for site in (spring, autumn)] == [200, 200]


@contextmanager
def registered(folder: Path, name: str, browser: httpx.Client) -> Iterator[str]:
    """Serve a season in which a browser gets an account."""
    made = make_season(folder, current=True)
    open_to_all = {"name": name, "registration": "open"}
    season = type(made)(folder, made.settings.model_copy(update=open_to_all))
    database = season.database()
    database.upgrade()
    with served(create_app(season, database)) as address:
        form = {"name": "ada", "password": "correct horse battery", "again": "correct horse battery"}
        assert browser.post(f"{address}/register", data=form).status_code == 303
        yield address
    database.close()
