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
from tests.leaderboard.hosting.clients import Site, serving_filled
from tests.leaderboard.seasons_made import changed

from wildscav_leaderboard.access.rate_limits import CODES, TRIES, Use, _digest
from wildscav_leaderboard.seasons.settings import Play
from wildscav_stage.playing.room import LASTING, LETTERS, LETTERS_OF_CODE


@contextmanager
def site(filled: FilledSeason, **play: Any) -> Iterator[Site]:
    """Serve a season whose organizer allows to play, unless said otherwise."""
    season = changed(filled.season, play=Play(**{"enabled": True, **play}))
    with filled.database.writing() as session:  # games of the test before do not count
        session.execute(delete(Use))
    with serving_filled(replace(filled, season=season), renders=False) as served:
        yield served
    assert served.app.state.tables.running == 0


def press(site: Site, asker: str, which: str = "active", track: str = "battle") -> httpx.Response:
    """Press the button on the page of a submission."""
    return site.ask(asker, f"/submissions/{{{which}}}/play", "POST", {"track": track})


def test_unless_the_organizer_allows_it_nobody_plays(hostile_season: FilledSeason) -> None:
    with site(hostile_season, enabled=False) as one:
        assert "Play against" not in one.ask("owner", "/submissions/{active}").text
        refused = press(one, "organizer")
        assert (refused.status_code, "in this season nobody plays" in refused.text) == (403, True)


def test_whoever_has_an_account_gets_one_table_and_no_more_than_there_are(
    hostile_season: FilledSeason,
) -> None:
    with site(hostile_season, tables=2) as one:
        for path in ("/submissions/{active}", "/matches/{ladder}"):
            assert re.search('action="/submissions/[0-9]+/play".*Play ', one.ask("other", path).text)
            assert "Log in to play" in one.ask("visitor", path).text

        first, again = press(one, "other"), press(one, "other")
        assert (first.status_code, again.headers["location"]) == (303, first.headers["location"])
        assert "Your game begins" in one.client.get(first.headers["location"]).text
        second = press(one, "other", track="navigation")
        assert second.status_code == 409
        assert "you play battle against night-owl 1.1 already: close its page" in second.text

        assert press(one, "owner").status_code == 303
        third = press(one, "organizer")
        assert third.status_code == 429
        assert "2 people can play at one time, and nobody else: try again" in third.text


def test_only_what_takes_part_and_is_allowed_can_be_played_against(hostile_season: FilledSeason) -> None:
    only = ": only those that take part"
    with site(hostile_season, tracks=("battle",)) as one:
        for which, track, why in (
            ("failed", "battle", f"is failed{only}"),
            ("cancelled", "battle", f"is cancelled{only}"),
            ("queued", "battle", f"is queued{only}"),
            ("active", "navigation", "in this season people play on battle"),
            ("active", "chess", "in this season people play on battle"),
        ):
            refused = press(one, "other", which, track)
            assert (refused.status_code, why in refused.text) == (403, True), which


def test_a_disqualified_team_cannot_be_played_against(hostile_season: FilledSeason) -> None:
    with site(hostile_season) as one:
        newts = one.client.get("/api/v1/submissions?team=newts").json()["submissions"]
        for number in [each["id"] for each in newts if each["team"] == "newts"]:
            refused = one.ask("other", f"/submissions/{number}/play", "POST", {"track": "battle"})
            assert (refused.status_code, "only those that take part" in refused.text) == (403, True)


def test_visitors_play_only_where_anybody_may(hostile_season: FilledSeason) -> None:
    with site(hostile_season) as one:
        sent = press(one, "visitor")
        assert (sent.status_code, sent.headers["location"]) == (303, "/login")
    with site(hostile_season, who="anybody") as one:
        assert press(one, "visitor").headers["location"].startswith("/play/")
        assert press(one, "visitor", track="navigation").status_code == 409  # one address


def test_a_form_of_another_site_or_session_opens_no_table(hostile_season: FilledSeason) -> None:
    path = f"/submissions/{hostile_season.submissions['active']}/play"
    with site(hostile_season, who="anybody") as one:
        foreign = one.client.post(
            path, data={"track": "battle"}, headers={"Origin": "https://elsewhere.example"}
        )
        assert (foreign.status_code, "from another site" in foreign.text) == (403, True)
        cookie = {"Cookie": f"{COOKIE}={hostile_season.people['other'].cookie}"}
        forged = one.client.post(path, data={"track": "battle", "csrf": "guessed"}, headers=cookie)
        assert (forged.status_code, "from another session" in forged.text) == (403, True)


def test_guests_enter_codes_only_where_tables_have_seats_for_them(hostile_season: FilledSeason) -> None:
    number = hostile_season.submissions["active"]
    with site(hostile_season) as one:  # a table has one seat
        assert one.client.get("/play").status_code == 403
        assert "Join a game" not in one.client.get(f"/submissions/{number}").text
    with site(hostile_season, people=2) as one:
        assert 'href="/play">Join a game by its code' in one.client.get(f"/submissions/{number}").text
        assert "six letters" in one.client.get("/play").text
        wrong = one.client.post("/play", data={"code": "bcdfgh"})
        assert (wrong.status_code, 'value="bcdfgh"' in wrong.text) == (404, True)
        assert "This code is not valid" in wrong.text


def test_whoever_guesses_codes_is_stopped_by_address_and_all_together(hostile_season: FilledSeason) -> None:
    with site(hostile_season, people=2) as one:
        answers = [one.client.post("/play", data={"code": "BCDFGH"}).status_code for _ in range(TRIES + 1)]
        assert answers == [404] * TRIES + [429]
        now = datetime.now(UTC)
        with hostile_season.database.writing() as session:
            session.execute(delete(Use))
            session.add_all(Use(key=_digest(("codes",)), at=now) for _ in range(CODES))
        assert one.client.post("/play", data={"code": "BCDFGH"}).status_code == 429
    guesses = CODES * LASTING / 60.0 * Play().tables
    assert guesses / len(LETTERS) ** LETTERS_OF_CODE < 1 / 15_000


def test_nobody_opens_tables_again_and_again(hostile_season: FilledSeason) -> None:
    with site(hostile_season) as one:
        answers = [press(one, "other").status_code for _ in range(7)]
    assert answers == [303] * 6 + [429]
