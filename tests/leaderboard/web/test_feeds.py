"""Feeds and badges: what others read and show of a season, on the season's own server."""

from collections.abc import Callable, Iterator
from datetime import UTC, datetime, timedelta
from xml.etree import ElementTree as ET

import httpx
import pytest
from sqlalchemy import update
from tests.leaderboard.filled_season import HOSTILE, FilledSeason
from tests.leaderboard.hosting.clients import Site, serving_filled

from wildscav_leaderboard.seasons.state import FROZEN, write_state
from wildscav_leaderboard.submissions.models import Submission

ATOM = "{http://www.w3.org/2005/Atom}"
URL = "https://arena.example"
HISTORY = "/api/v1/boards/battle/history?team=owls&team=foxes"


@pytest.fixture(scope="module")
def site(new_filled_season: Callable[..., FilledSeason]) -> Iterator[Site]:
    filled = new_filled_season(words=HOSTILE, web=f'url = "{URL}/"')
    with serving_filled(filled) as one:
        yield one


def entries(response: httpx.Response) -> list[ET.Element]:
    assert response.headers["content-type"].startswith("application/atom+xml")
    return ET.fromstring(response.content).findall(f"{ATOM}entry")  # noqa: S314 (our own)


def text(entry: ET.Element, name: str) -> str:
    return entry.findtext(f"{ATOM}{name}") or ""


def test_announcements_have_a_feed_with_names_that_stay(site: Site) -> None:
    response = site.client.get("/feeds/announcements.atom")
    (entry,) = entries(response)

    assert response.headers["vary"] == "Host"
    assert text(entry, "title") == site.filled.words.announcement
    assert text(entry, "content") == site.filled.words.text
    opens = site.filled.season.settings.opens
    assert text(entry, "id") == f"tag:arena.example,{opens:%Y-%m-%d}:trial/announcements/1"
    link = entry.find(f"{ATOM}link")
    assert link is not None
    assert link.get("href") == f"{URL}/#announcement-1"
    assert 'id="announcement-1"' in site.client.get("/").text


def test_every_change_on_a_board_is_in_its_feed_once_the_latest_first(site: Site) -> None:
    found = entries(site.client.get("/feeds/battle.atom"))
    times = [datetime.fromisoformat(text(entry, "updated")) for entry in found]

    assert len({text(entry, "id") for entry in found}) == len(found) > 5
    assert times == sorted(times, reverse=True)
    assert all("rank " in text(entry, "title") for entry in found)


def test_a_boards_feed_names_the_interface_of_who_does_not_play_by_numbers(site: Site) -> None:
    for interface, named in (("words", "(words), "), (None, "night-owl 1.1, ")):
        with site.filled.database.writing() as session:
            session.execute(update(Submission).values(interface=interface))
        said = [text(entry, "content") for entry in entries(site.client.get("/feeds/battle.atom"))]
        assert any("With night-owl 1.1" in one and named in one for one in said)
        assert any("(words)" in one for one in said) == (interface == "words")


def test_a_badge_tells_the_rank_to_other_sites_and_can_load_nothing_there(site: Site) -> None:
    rows = site.client.get("/api/v1/boards/battle").json()["rows"]
    row = next(row for row in rows if row["team"] == "foxes")
    whose = ("teams/foxes", f"submissions/{row['submission']}")
    answers = [site.client.get(f"/badges/battle/{one}.svg") for one in whose]
    ranks = "–".join(str(rank) for rank in sorted({row["rank"], row["last_rank"]}))

    for answer in answers:
        assert f"battle: rank {ranks} of " in answer.text
        ET.fromstring(answer.content)  # noqa: S314 (our own)
        assert answer.headers["cross-origin-resource-policy"] == "cross-origin"
        assert answer.headers["content-security-policy"] == "default-src 'none'; frame-ancestors *"
        assert "max-age=300" in answer.headers["cache-control"]


def test_a_team_without_a_row_is_not_ranked_and_an_unknown_one_is_not_there(site: Site) -> None:
    assert "not ranked" in site.client.get("/badges/battle/teams/newts.svg").text  # it is disqualified
    assert site.client.get("/badges/battle/teams/nobody.svg").status_code == 404
    assert site.client.get("/badges/chess/teams/owls.svg").status_code == 404


def test_a_frozen_season_tells_its_course_until_then_except_to_organizers(site: Site) -> None:
    whole = site.client.get(HISTORY).json()
    feed = entries(site.client.get("/feeds/battle.atom"))
    frozen = datetime.fromisoformat(sorted(point["at"] for point in whole)[2])
    with site.filled.database.writing() as session:
        write_state(session, FROZEN, {"at": frozen.isoformat()}, datetime.now(UTC))
    try:
        seen = site.client.get(HISTORY).json()
        assert 0 < len(seen) < len(whole)
        assert all(datetime.fromisoformat(point["at"]) <= frozen for point in seen)
        assert 0 < len(entries(site.client.get("/feeds/battle.atom"))) < len(feed)
        assert site.ask("organizer", HISTORY).json() == whole
    finally:
        with site.filled.database.writing() as session:
            write_state(session, FROZEN, None, datetime.now(UTC) + timedelta(seconds=1))
