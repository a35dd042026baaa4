"""What pages tell whoever reads them: where a submission stands, what cannot be seen yet, and who is who."""

import re
from collections.abc import Iterator
from html import unescape

import httpx
import pytest
from tests.leaderboard.filled_season import COOKIE, HOSTILE, FilledSeason
from tests.leaderboard.hosting.clients import ask
from tests.leaderboard.spectating.served import served

from wildscav_leaderboard.hosting.app import create_app

FIRST = 1  # the first submission of the owls, who have a better one


@pytest.fixture(scope="module")
def client(hostile_season: FilledSeason) -> Iterator[httpx.Client]:
    app = create_app(hostile_season.season, hostile_season.database)
    with served(app) as address, httpx.Client(base_url=address, timeout=60.0) as opened:
        yield opened
    app.state.renders.close()


def text_of(client: httpx.Client, filled: FilledSeason, path: str, asker: str = "visitor") -> str:
    """Return the words of a page's content, on one line."""
    page = ask(client, filled, asker, "GET", path.format(**filled.submissions, **filled.matches))
    assert page.status_code == 200
    content = page.text.partition("<main")[2].partition("</main>")[0]
    return " ".join(unescape(re.sub("<[^>]*>", " ", content)).split())


def test_people_read_titles_and_versions(client: httpx.Client, hostile_season: FilledSeason) -> None:
    match = text_of(client, hostile_season, "/matches/{own_suite}")
    assert HOSTILE.title in match
    assert "night-owl 1.1" in match
    assert "night-owl-" not in match
    assert f"{HOSTILE.title} · submission" in text_of(client, hostile_season, "/submissions/{active}")


def test_the_matches_of_a_suite_are_counted_from_one(
    client: httpx.Client, hostile_season: FilledSeason
) -> None:
    first = ask(client, hostile_season, "visitor", "GET", "/api/v1/matches?track=navigation").json()[
        "matches"
    ][-1]
    assert first["number"] == 0
    assert "number 1 of its suite" in text_of(client, hostile_season, f"/matches/{first['id']}")


def test_results_that_cannot_be_seen_are_named_once(
    client: httpx.Client, hostile_season: FilledSeason
) -> None:
    path = f"/submissions/{{active}}?before={hostile_season.matches['own_suite'] + 1}"
    page = text_of(client, hostile_season, path)
    assert page.count("cannot be seen yet: everyone plays this match of the suite") == 1
    assert "cannot be seen yet: everyone plays" in text_of(client, hostile_season, path, "owner")
    assert "cannot be seen" not in text_of(client, hostile_season, path, "organizer")
    match = text_of(client, hostile_season, "/matches/{own_suite}")
    assert "The result cannot be seen yet: everyone plays this match" in match
    assert "p99" not in match  # no column without anything in it
    assert "p99" in text_of(client, hostile_season, "/matches/{own_suite}", "organizer")


def test_who_submits_is_told_the_sandbox_and_its_limits(
    client: httpx.Client, hostile_season: FilledSeason, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert "Agents run in the sandbox process." in text_of(client, hostile_season, "/submit", "owner")

    execution = hostile_season.season.settings.execution
    monkeypatch.setitem(execution.__dict__, "sandbox", "bubblewrap")
    page = text_of(client, hostile_season, "/submit", "owner")

    assert "Agents run in the sandbox bubblewrap." in page
    assert "wildscav check my-agent --season http" in page
    assert "navigation: 1 core, 2.0GiB of memory, 256.0MiB in /tmp, 256 processes" in page


def test_a_track_without_a_rank_says_why(client: httpx.Client, hostile_season: FilledSeason) -> None:
    worse = text_of(client, hostile_season, f"/submissions/{FIRST}")
    assert "The board shows the best submission of its team, night-owl 1.1 ." in worse
    waiting = text_of(client, hostile_season, "/submissions/{queued}")
    assert "Not ranked" not in waiting


def test_a_submission_without_matches_says_whether_it_gets_some(
    client: httpx.Client, hostile_season: FilledSeason
) -> None:
    waiting = text_of(client, hostile_season, "/submissions/{queued}")
    assert waiting.endswith("Matches None yet. They are planned once the submission is active.")
    for name in ("failed", "cancelled"):
        assert text_of(client, hostile_season, f"/submissions/{{{name}}}").endswith("Matches None.")


def test_its_team_sees_what_a_submission_will_replace(
    client: httpx.Client, hostile_season: FilledSeason
) -> None:
    replaces = "When it takes part, it replaces submission"
    assert replaces in text_of(client, hostile_season, "/submissions/{queued}", "organizer")
    assert replaces not in text_of(client, hostile_season, "/submissions/{queued}")


def test_a_teams_failures_are_on_its_page_for_itself_alone(
    client: httpx.Client, hostile_season: FilledSeason
) -> None:
    for asker, shown in {"visitor": False, "opponent": False, "owner": True, "organizer": True}.items():
        page = text_of(client, hostile_season, "/teams/owls", asker)
        assert "night-owl 1.1" in page
        assert ("2.0-rc1" in page) == shown, asker


def test_counts_have_the_right_number(client: httpx.Client, hostile_season: FilledSeason) -> None:
    assert " 1 teams" not in text_of(client, hostile_season, "/")


def test_an_own_suite_is_not_called_by_its_file(client: httpx.Client, hostile_season: FilledSeason) -> None:
    home = text_of(client, hostile_season, "/")
    assert "the same matches of the organizers' own suite, on hidden seeds" in home
    assert ".toml" not in home


@pytest.mark.parametrize("path", ["/register", "/boards/battle"])
def test_the_header_marks_where_one_is(client: httpx.Client, path: str) -> None:
    assert f'href="{path}" aria-current="page"' in client.get(path).text


def test_both_commitments_are_at_the_foot_of_every_page(
    client: httpx.Client, hostile_season: FilledSeason
) -> None:
    foot = client.get("/login").text.partition("<footer>")[2]
    for seed in (hostile_season.season.seed, hostile_season.season.final_seed):
        assert str(seed.commitment)[:16] in foot


def test_intervals_are_numbers_too(client: httpx.Client, hostile_season: FilledSeason) -> None:
    assert re.search(r"\d – \d", text_of(client, hostile_season, "/boards/navigation"))


def test_a_match_says_how_to_watch_it_in_every_way(
    client: httpx.Client, hostile_season: FilledSeason
) -> None:
    number = hostile_season.matches["ladder"]
    page = text_of(client, hostile_season, f"/matches/{number}")
    for way in ("From above", "Watch the video", "Watch in 3D", f"wildscav replay match-{number}.wsr"):
        assert way in page
    assert f"wildscav replay match-{number}.wsr --video --view behind" in page


def rows_of(client: httpx.Client, filled: FilledSeason, path: str, asker: str = "visitor") -> list[str]:
    """Return the words of each row of a page's list of matches."""
    page = ask(client, filled, asker, "GET", path).text.partition("<tbody>")[2].partition("</tbody>")[0]
    return [" ".join(unescape(re.sub("<[^>]*>", " ", row)).split()) for row in page.split("</tr>")[:-1]]


def test_matches_are_listed_live_ones_first_with_their_winners(
    client: httpx.Client, hostile_season: FilledSeason
) -> None:
    rows = rows_of(client, hostile_season, "/matches")
    assert "playing" in rows[0]
    assert rows[0].endswith(f" {hostile_season.matches['playing']}")
    numbers = [int(row.split()[-1]) for row in rows[1:]]
    assert numbers == sorted(numbers, reverse=True)
    assert not any("playing" in row or "waiting" in row for row in rows[1:])
    match = client.get(f"/api/v1/matches/{hostile_season.matches['ladder']}").json()
    who = " vs ".join(seat["team_title"] or seat["name"] for seat in match["seats"])
    assert any(row.startswith(f"{who} {match['winner']} battle ") for row in rows)
    suite = [row for row in rows[1:] if " navigation " in row]
    assert all(" hidden navigation " in row for row in suite)  # neither who won, nor when it ended
    assert all("hidden" not in row for row in rows_of(client, hostile_season, "/matches", "organizer"))


def test_lists_of_matches_are_chosen_and_go_on(client: httpx.Client, hostile_season: FilledSeason) -> None:
    chosen = "track=battle&state=finished"
    first, listed = f"/matches?{chosen}", client.get(f"/api/v1/matches?{chosen}").json()["matches"]
    page = unescape(client.get(first).text)
    rows = rows_of(client, hostile_season, first)
    assert all(" battle " in row for row in rows)
    (more,) = re.findall(r'href="(\?[^"]*before=[^"]*)"', page)
    rows += rows_of(client, hostile_season, f"/matches{more}")
    assert [int(row.split()[-1]) for row in rows] == [one["id"] for one in listed][: len(rows)]
    assert len(rows) > len(rows_of(client, hostile_season, first))
    of_hares = rows_of(client, hostile_season, f"{first}&team=hares")
    assert of_hares
    assert all("Hares & Hounds" in row and " battle " in row for row in of_hares)
    assert rows_of(client, hostile_season, "/matches?state=waiting&team=newts") == []
    assert 'href="/matches"' in client.get("/").text


def test_the_seasons_page_shows_the_latest_match_that_everyone_may_watch(
    client: httpx.Client, hostile_season: FilledSeason
) -> None:
    rendered = hostile_season.season.files / "rendered"
    assert "og:description" in client.get("/").text
    assert "og:image" not in client.get("/", headers={"Host": "evil.example"}).text
    numbers = [hostile_season.matches[kind] for kind in ("ladder", "suite", "own_suite")]
    pictures = [rendered / f"{number}.poster-1.jpg" for number in numbers]
    rendered.mkdir(exist_ok=True)
    for picture in pictures:
        picture.write_bytes(b"")
    try:
        page = ask(client, hostile_season, "organizer", "GET", "/").text
        match = client.get(f"/matches/{numbers[0]}").text
    finally:
        for picture in pictures:
            picture.unlink()

    path = f"/api/v1/matches/{numbers[0]}/poster.jpg"
    assert re.findall(r'<img src="(/api[^"]*)"', page) == [path]
    assert re.findall(r'og:image" content="([^"]*)"', page) == [f"http://127.0.0.1:8000{path}"]
    assert f'<a href="/matches/{numbers[0]}">' in page
    assert f'<img src="{path}"' in match  # without scripts, too
    assert "<noscript><img" not in match


def test_where_the_record_is_hidden_so_are_video_and_poster(
    client: httpx.Client, hostile_season: FilledSeason
) -> None:
    number = hostile_season.matches["suite"]
    for name in ("video", "video.mp4", "poster.jpg"):
        answer = client.get(f"/api/v1/matches/{number}/{name}")
        assert (answer.status_code, "hidden until" in answer.json()["error"]) == (403, True)
    page = client.get(f"/matches/{number}?video=true").text
    assert "og:image" not in page
    assert "<video" not in page
    assert "Watch the video" not in page


@pytest.mark.parametrize("path", ["/", "/submit", "/account", "/teams/owls"])
def test_what_people_copy_from_a_page_names_the_address_of_the_settings(
    client: httpx.Client, hostile_season: FilledSeason, path: str
) -> None:
    cookie = f"{COOKIE}={hostile_season.people['owner'].cookie}"
    page = client.get(path, headers={"Host": "evil.example", "Cookie": cookie})

    assert page.status_code == 200
    assert "evil.example" not in page.text
    assert "http://127.0.0.1:8000" in page.text


def test_organizers_are_offered_to_run_again_only_what_can_be(
    client: httpx.Client, hostile_season: FilledSeason
) -> None:
    failed = text_of(client, hostile_season, "/organizer/submissions?state=failed", "organizer")
    assert "Run again submission" in failed
    active = text_of(client, hostile_season, "/organizer/submissions?state=active", "organizer")
    assert "Disqualify submission" in active
    assert "Run again" not in active  # none of their matches was given up
