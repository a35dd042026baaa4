"""What pages tell whoever reads them: where a submission stands, what cannot be seen yet, and who is who."""

import gzip
import re
from collections.abc import Iterator
from contextlib import contextmanager
from html import unescape
from pathlib import Path

import pytest
from sqlalchemy import update
from sqlalchemy.orm import Session
from tests.leaderboard.filled_season import COOKIE, HOSTILE
from tests.leaderboard.hosting.clients import Site

from wildscav_leaderboard.boards.documents import BoardDocument, LadderBoard
from wildscav_leaderboard.boards.kept import read_board
from wildscav_leaderboard.matches.models import SUITE, Match
from wildscav_leaderboard.visibility import is_anything_shown, perhaps_shown
from wildscav_leaderboard.web import public
from wildscav_stage import viewer_files
from wildscav_stage.scene.map_file import MAP_VERSION

FIRST = 1  # the first submission of the owls, who have a better one


class Pages(Site):
    """A served season, whose pages are read as text."""

    def text(self, path: str, asker: str = "visitor") -> str:
        """Return the words of a page's content, on one line."""
        page = self.ask(asker, path)
        assert page.status_code == 200
        return words(page.text.partition("<main")[2].partition("</main>")[0])

    def rows(self, path: str, asker: str = "visitor") -> list[str]:
        """Return the words of each row of a page's list of matches."""
        page = self.ask(asker, path).text.partition("<tbody>")[2].partition("</tbody>")[0]
        return [words(row) for row in page.split("</tr>")[:-1]]


def words(content: str) -> str:
    return " ".join(unescape(re.sub("<[^>]*>", " ", content)).split())


@pytest.fixture
def site(hostile_site: Site) -> Pages:
    return Pages(*hostile_site)


REPLACES = "When it takes part, it replaces submission"
WAYS = ("Watch the video", "Open in Rerun", "wildscav watch match-", ".wsr --html")
# Path, who reads it, what is there, and what is not.
SAID: list[tuple[str, str, tuple[str, ...], tuple[str, ...]]] = [
    # People read titles and versions, not the names of entrants.
    ("/matches/{own_suite}", "visitor", (HOSTILE.title, "night-owl 1.1"), ("night-owl-",)),
    ("/submissions/{active}", "visitor", (f"{HOSTILE.title} · submission",), ()),
    # A track without a rank says why.
    (
        f"/submissions/{FIRST}",
        "visitor",
        ("The board shows the best submission of its team, night-owl 1.1 .",),
        (),
    ),
    # A submission without matches says whether it gets some; its team sees what it will replace.
    (
        "/submissions/{queued}",
        "visitor",
        ("None yet. They are planned once the submission is active.",),
        ("Not ranked", REPLACES),
    ),
    ("/submissions/{queued}", "organizer", (REPLACES,), ()),
    ("/submissions/{failed}", "visitor", ("Matches None.",), ()),
    ("/submissions/{cancelled}", "visitor", ("Matches None.",), ()),
    # A team's failures are on its page for itself alone.
    ("/teams/owls", "visitor", ("night-owl 1.1",), ("2.0-rc1",)),
    ("/teams/owls", "opponent", ("night-owl 1.1",), ("2.0-rc1",)),
    ("/teams/owls", "owner", ("night-owl 1.1", "2.0-rc1"), ()),
    ("/teams/owls", "organizer", ("night-owl 1.1", "2.0-rc1"), ()),
    # An organizer's own suite is not called by its file, and one team is no "1 teams".
    (
        "/",
        "visitor",
        ("the same matches of the organizers' own suite, on hidden seeds",),
        (".toml", " 1 teams"),
    ),
    ("/matches/{ladder}", "visitor", WAYS, ()),
    # Organizers are offered to run again only what can be.
    ("/organizer/submissions?state=failed", "organizer", ("Run again submission",), ()),
    ("/organizer/submissions?state=active", "organizer", ("Disqualify submission",), ("Run again",)),
]


@pytest.mark.parametrize(("path", "asker", "there", "not_there"), SAID)
def test_a_page_says(
    site: Pages, path: str, asker: str, there: tuple[str, ...], not_there: tuple[str, ...]
) -> None:
    page = site.text(path, asker)
    assert [text for text in there if text not in page] == []
    assert [text for text in not_there if text in page] == []


@pytest.mark.parametrize("path", ["/register", "/boards/battle"])
def test_the_header_marks_where_one_is(site: Pages, path: str) -> None:
    assert f'href="{path}" aria-current="page"' in site.client.get(path).text


def test_the_matches_of_a_suite_are_counted_from_one(site: Pages) -> None:
    first = site.ask("visitor", "/api/v1/matches?track=navigation").json()["matches"][-1]
    assert first["number"] == 0
    assert "number 1 of its suite" in site.text(f"/matches/{first['id']}")


def test_results_that_cannot_be_seen_are_named_once(site: Pages) -> None:
    path = f"/submissions/{{active}}?before={site.filled.matches['own_suite'] + 1}"
    page = site.text(path)
    assert page.count("cannot be seen yet: every submission plays this match of the suite") == 1
    assert "cannot be seen yet: every submission plays" in site.text(path, "owner")
    assert "cannot be seen" not in site.text(path, "organizer")
    match = site.text("/matches/{own_suite}")
    assert "The result cannot be seen yet: every submission plays this match" in match
    assert "p99" not in match  # no column without anything in it
    assert "p99" in site.text("/matches/{own_suite}", "organizer")


def test_who_submits_is_told_the_sandbox_and_its_limits(site: Pages, monkeypatch: pytest.MonkeyPatch) -> None:
    assert "Agents run in the sandbox process." in site.text("/submit", "owner")

    execution = site.filled.season.settings.execution
    monkeypatch.setitem(execution.__dict__, "sandbox", "bubblewrap")
    page = site.text("/submit", "owner")

    assert "Agents run in the sandbox bubblewrap." in page
    assert "wildscav check my-agent --season http" in page
    assert "navigation: 1 core, 2.0GiB of memory, 256.0MiB in /tmp, 256 processes" in page


def test_both_commitments_are_at_the_foot_of_every_page(site: Pages) -> None:
    foot = site.client.get("/login").text.partition("<footer>")[2]
    for seed in (site.filled.season.seed, site.filled.season.final_seed):
        assert str(seed.commitment)[:16] in foot


def test_intervals_are_numbers_too(site: Pages) -> None:
    assert re.search(r"\d – \d", site.text("/boards/navigation"))


def test_matches_are_listed_live_ones_first_with_their_winners(site: Pages) -> None:
    rows = site.rows("/matches")
    assert "playing" in rows[0]
    assert rows[0].endswith(f" {site.filled.matches['playing']}")
    numbers = [int(row.split()[-1]) for row in rows[1:]]
    assert numbers == sorted(numbers, reverse=True)
    assert not any("playing" in row or "waiting" in row for row in rows[1:])
    match = site.client.get(f"/api/v1/matches/{site.filled.matches['ladder']}").json()
    who = " vs ".join(seat["team_title"] or seat["name"] for seat in match["seats"])
    assert any(row.startswith(f"{who} {match['winner']} battle ") for row in rows)
    suite = [row for row in rows[1:] if " navigation " in row]
    assert all(" hidden navigation " in row for row in suite)  # neither who won, nor when it ended
    assert all("hidden" not in row for row in site.rows("/matches", "organizer"))


def test_lists_of_matches_are_chosen_and_go_on(site: Pages) -> None:
    chosen = "track=battle&state=finished"
    first, listed = f"/matches?{chosen}", site.client.get(f"/api/v1/matches?{chosen}").json()["matches"]
    page = unescape(site.client.get(first).text)
    rows = site.rows(first)
    assert all(" battle " in row for row in rows)
    (more,) = re.findall(r'href="(\?[^"]*before=[^"]*)"', page)
    rows += site.rows(f"/matches{more}")
    assert [int(row.split()[-1]) for row in rows] == [one["id"] for one in listed][: len(rows)]
    assert len(rows) > len(site.rows(first))
    of_hares = site.rows(f"{first}&team=hares")
    assert of_hares
    assert all("Hares & Hounds" in row and " battle " in row for row in of_hares)
    assert site.rows("/matches?state=waiting&team=newts") == []
    assert 'href="/matches"' in site.client.get("/").text


def test_the_seasons_page_shows_the_latest_match_that_everyone_may_watch(site: Pages) -> None:
    assert "og:description" in site.client.get("/").text
    assert "og:image" not in site.client.get("/", headers={"Host": "evil.example"}).text
    numbers = [site.filled.matches[kind] for kind in ("ladder", "suite", "own_suite")]

    with rendered(site, *(f"{number}.poster-1.jpg" for number in numbers)):
        page = site.ask("organizer", "/").text

    path = f"/api/v1/matches/{numbers[0]}/poster.jpg"
    assert re.findall(r'<img src="(/api[^"]*)"', page) == [path]
    assert re.findall(r'og:image" content="([^"]*)"', page) == [f"http://127.0.0.1:8000{path}"]
    assert f'<a href="/matches/{numbers[0]}">' in page


def test_matches_are_offered_where_one_may_be_watched(site: Pages) -> None:
    assert "Watch matches" in site.text("/")

    with site.filled.database.writing() as session:
        session.execute(update(Match).values(kind=SUITE))
        is_offered = is_anything_shown(session, perhaps_shown(session))
        session.rollback()

    assert not is_offered  # of a suite, nobody may see any before the season's end


def test_the_first_page_shows_no_rating_of_few_matches_and_offers_none_that_nobody_may_watch(
    site: Pages, monkeypatch: pytest.MonkeyPatch
) -> None:
    def with_few_matches(session: Session, track: str) -> BoardDocument | None:
        board = read_board(session, track)
        if not isinstance(board, LadderBoard):
            return board
        few = {"provisional": True, "matches": 4, "planned": 24}
        return board.model_copy(update={"rows": tuple(row.model_copy(update=few) for row in board.rows)})

    monkeypatch.setattr(public, "read_board", with_few_matches)
    monkeypatch.setattr(public, "is_anything_shown", lambda *_: False)
    page = site.text("/")

    assert page.count("provisional") == public.LEADERS
    assert "Watch matches" not in page


@contextmanager
def rendered(site: Pages, *names: str, content: bytes = b"") -> Iterator[None]:
    """Let files be there that are rendered of matches."""
    folder = site.filled.season.files / "rendered"
    folder.mkdir(exist_ok=True)
    for name in names:
        (folder / name).write_bytes(content)
    try:
        yield
    finally:
        for name in names:
            (folder / name).unlink()


def test_where_the_record_is_hidden_so_are_video_and_poster(site: Pages) -> None:
    number = site.filled.matches["suite"]
    for name in ("video", "video.mp4", "poster.jpg"):
        answer = site.client.get(f"/api/v1/matches/{number}/{name}")
        assert (answer.status_code, "hidden until" in answer.json()["error"]) == (403, True)
    assert site.client.get(f"/matches/{number}/video").status_code == 403
    page = site.client.get(f"/matches/{number}").text
    assert "og:image" not in page
    assert "Watch the video" not in page


def test_a_map_is_kept_by_browsers_for_ever_and_what_draws_it_as_well(site: Pages) -> None:
    number = site.filled.matches["ladder"]
    with rendered(site, f"{number}.map-{MAP_VERSION}.gz", content=gzip.compress(b"a map")):
        address = re.findall(r'data-map="([^"]*)"', site.client.get(f"/matches/{number}").text)[0]
        answer = site.client.get(address)
        others = [site.client.get(address.partition("?")[0] + query) for query in ("", f"?v={MAP_VERSION}")]
    assert re.fullmatch(rf"/api/v1/matches/{number}/map\?v=[0-9a-f]{{16}}", address)
    # An address that does not name this very map may have another one tomorrow, of another season.
    assert {other.headers["Cache-Control"] for other in others} == {"private, max-age=86400"}
    assert (answer.content, answer.headers["Content-Encoding"]) == (b"a map", "gzip")
    assert answer.headers["Cache-Control"] == "private, max-age=31536000, immutable"
    script = re.findall(r'src="(/stage/[^"]*)"', site.client.get(f"/matches/{number}").text)[0]
    assert "immutable" in site.client.get(script).headers["Cache-Control"]


def test_two_matches_are_shown_side_by_side_if_both_may_be_seen(site: Pages) -> None:
    number = site.filled.matches["ladder"]
    page = site.client.get(f"/matches/{number}?with={number}").text
    assert re.findall(r'data-title="([^"]*)"', page) == 2 * [f"Match {number}"]
    assert page.count("data-with>") == 1
    assert page.count("data-live") == 0
    assert site.client.get(f"/matches/{number}?with={site.filled.matches['own_suite']}").status_code == 403
    assert site.client.get(f"/matches/{number}?with=99999").status_code == 404


def test_without_a_viewer_a_match_page_says_so_without_paths(
    site: Pages, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(viewer_files, "FOLDER", tmp_path)
    page = site.client.get(f"/matches/{site.filled.matches['ladder']}").text
    assert "cannot be shown in 3D here" in page
    assert str(tmp_path) not in page
    assert "data-match" not in page
    assert "Watch the video" in page


@pytest.mark.parametrize("path", ["/", "/submit", "/account", "/teams/owls"])
def test_what_people_copy_from_a_page_names_the_address_of_the_settings(site: Pages, path: str) -> None:
    cookie = f"{COOKIE}={site.filled.people['owner'].cookie}"
    page = site.client.get(path, headers={"Host": "evil.example", "Cookie": cookie})

    assert page.status_code == 200
    assert "evil.example" not in page.text
    assert "http://127.0.0.1:8000" in page.text
