"""Playing against a submission: who may, against which, and how many at one time."""

import re
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from datetime import UTC, datetime
from typing import Any

import httpx
from sqlalchemy import delete
from tests.leaderboard.filled_season import COOKIE, FilledSeason
from tests.leaderboard.hosting.clients import ask
from tests.leaderboard.spectating.served import served

from wildscav_leaderboard.access.rate_limits import CODES, TRIES, Use, _digest
from wildscav_leaderboard.hosting.app import create_app
from wildscav_leaderboard.playing.tables import Tables
from wildscav_leaderboard.seasons.settings import Play
from wildscav_stage.playing.room import LASTING, LETTERS, LETTERS_OF_CODE


@contextmanager
def site(filled: FilledSeason, **play: Any) -> Iterator[httpx.Client]:
    """Serve a season whose organizer allows to play, unless said otherwise."""
    settings = filled.season.settings.model_copy(update={"play": Play(**{"enabled": True, **play})})
    app = create_app(replace(filled.season, settings=settings), filled.database)
    tables: Tables = app.state.tables
    with filled.database.writing() as session:  # games of the test before do not count
        session.execute(delete(Use))
    try:
        with served(app) as address, httpx.Client(base_url=address, timeout=60.0) as client:
            yield client
    finally:
        tables.close()
        app.state.renders.close()
        assert tables.running == 0


def press(
    client: httpx.Client, filled: FilledSeason, asker: str, which: str = "active", track: str = "battle"
) -> httpx.Response:
    """Press the button on the page of a submission."""
    path = f"/submissions/{filled.submissions[which]}/play"
    return ask(client, filled, asker, "POST", path, {"track": track})


def test_unless_the_organizer_allows_it_nobody_plays(hostile_season: FilledSeason) -> None:
    with site(hostile_season, enabled=False) as client:
        page = ask(
            client, hostile_season, "owner", "GET", f"/submissions/{hostile_season.submissions['active']}"
        )
        assert "Play against" not in page.text
        refused = press(client, hostile_season, "organizer")
        assert (refused.status_code, "in this season nobody plays" in refused.text) == (403, True)


def test_whoever_has_an_account_gets_one_table_and_no_more_than_there_are(
    hostile_season: FilledSeason,
) -> None:
    number = hostile_season.submissions["active"]
    with site(hostile_season, tables=2) as client:
        for path in (f"/submissions/{number}", f"/matches/{hostile_season.matches['ladder']}"):
            shown = ask(client, hostile_season, "other", "GET", path).text
            assert re.search('action="/submissions/[0-9]+/play".*Play ', shown)
            assert "Log in to play" in client.get(path).text

        first = press(client, hostile_season, "other")
        assert first.status_code == 303
        assert "Your game begins" in client.get(first.headers["location"]).text
        assert (
            press(client, hostile_season, "other").headers["location"] == first.headers["location"]
        )  # pressed twice
        second = press(client, hostile_season, "other", track="navigation")
        assert second.status_code == 409
        assert "you play battle against night-owl 1.1 already: close its page" in second.text

        assert press(client, hostile_season, "owner").status_code == 303
        third = press(client, hostile_season, "organizer")
        assert third.status_code == 429
        assert "2 people can play at one time, and nobody else: try again" in third.text


def test_only_what_takes_part_and_is_allowed_can_be_played_against(hostile_season: FilledSeason) -> None:
    only = ": only those that take part"
    with site(hostile_season, tracks=("battle",)) as client:
        for which, track, why in (
            ("failed", "battle", f"is failed{only}"),
            ("cancelled", "battle", f"is cancelled{only}"),
            ("queued", "battle", f"is queued{only}"),
            ("active", "navigation", "in this season people play on battle"),
            ("active", "chess", "in this season people play on battle"),
        ):
            refused = press(client, hostile_season, "other", which, track)
            assert (refused.status_code, why in refused.text) == (403, True), which


def test_a_disqualified_team_cannot_be_played_against(hostile_season: FilledSeason) -> None:
    with site(hostile_season) as client:
        newts = client.get("/api/v1/submissions?team=newts").json()["submissions"]
        for number in [one["id"] for one in newts if one["team"] == "newts"]:
            refused = ask(
                client, hostile_season, "other", "POST", f"/submissions/{number}/play", {"track": "battle"}
            )
            assert (refused.status_code, "only those that take part" in refused.text) == (403, True)


def test_visitors_play_only_where_anybody_may(hostile_season: FilledSeason) -> None:
    with site(hostile_season) as client:
        sent = press(client, hostile_season, "visitor")
        assert (sent.status_code, sent.headers["location"]) == (303, "/login")
    with site(hostile_season, who="anybody") as client:
        assert press(client, hostile_season, "visitor").headers["location"].startswith("/play/")
        assert press(client, hostile_season, "visitor", track="navigation").status_code == 409  # one address


def test_a_form_of_another_site_or_session_opens_no_table(hostile_season: FilledSeason) -> None:
    path = f"/submissions/{hostile_season.submissions['active']}/play"
    with site(hostile_season, who="anybody") as client:
        foreign = client.post(path, data={"track": "battle"}, headers={"Origin": "https://elsewhere.example"})
        assert (foreign.status_code, "from another site" in foreign.text) == (403, True)
        cookie = {"Cookie": f"{COOKIE}={hostile_season.people['other'].cookie}"}
        forged = client.post(path, data={"track": "battle", "csrf": "guessed"}, headers=cookie)
        assert (forged.status_code, "from another session" in forged.text) == (403, True)


def test_guests_enter_codes_only_where_tables_have_seats_for_them(hostile_season: FilledSeason) -> None:
    number = hostile_season.submissions["active"]
    with site(hostile_season) as client:  # a table has one seat
        assert client.get("/play").status_code == 403
        assert "Join a game" not in client.get(f"/submissions/{number}").text
    with site(hostile_season, people=2) as client:
        assert 'href="/play">Join a game by its code' in client.get(f"/submissions/{number}").text
        assert "six letters" in client.get("/play").text
        wrong = client.post("/play", data={"code": "bcdfgh"})
        assert (wrong.status_code, 'value="bcdfgh"' in wrong.text) == (404, True)
        assert "This code is not valid" in wrong.text


def test_whoever_guesses_codes_is_stopped_by_address_and_all_together(hostile_season: FilledSeason) -> None:
    with site(hostile_season, people=2) as client:
        answers = [client.post("/play", data={"code": "BCDFGH"}).status_code for _ in range(TRIES + 1)]
        assert answers == [404] * TRIES + [429]
        now = datetime.now(UTC)
        with hostile_season.database.writing() as session:
            session.execute(delete(Use))
            session.add_all(Use(key=_digest(("codes",)), at=now) for _ in range(CODES))
        assert client.post("/play", data={"code": "BCDFGH"}).status_code == 429
    guesses = CODES * LASTING / 60.0 * Play().tables
    assert guesses / len(LETTERS) ** LETTERS_OF_CODE < 1 / 15_000


def test_nobody_opens_tables_again_and_again(hostile_season: FilledSeason) -> None:
    with site(hostile_season) as client:
        answers = [press(client, hostile_season, "other").status_code for _ in range(7)]
    assert answers == [303] * 6 + [429]
