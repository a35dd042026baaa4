"""Pages with a recorded match: what is in them, and what names in them cannot do."""

import base64
import hashlib
import re
from collections.abc import Callable
from html.parser import HTMLParser
from pathlib import Path

import pytest
from tests.platform.stage.built_viewer import LEGAL, SCRIPT
from tests.recorded_matches import SMALL_MAP

from wildscav.errors import UserError
from wildscav_engine.record import write_record
from wildscav_engine.simulation.match import Match
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_stage.watching.match_page import Scene, Shown, list_page, match_page, scene_of, whole_page

HOSTILE = "</script><script>alert(1)</script>"
Records = Callable[[str], Path]


class Elements(HTMLParser):
    """The elements of a page, with their attributes and their texts."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.found: list[tuple[str, dict[str, str | None], str]] = []
        self.comments: list[str] = []
        self.feed(page)
        self.close()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.found.append((tag, dict(attrs), ""))

    def handle_endtag(self, tag: str) -> None:
        self.found.append(("", {}, ""))  # what follows is not in it

    def handle_data(self, data: str) -> None:
        if self.found:
            tag, attributes, text = self.found[-1]
            self.found[-1] = (tag, attributes, text + data)

    def handle_comment(self, data: str) -> None:
        self.comments.append(data)

    def called(self, tag: str) -> list[tuple[dict[str, str | None], str]]:
        return [(attributes, text) for name, attributes, text in self.found if name == tag]


@pytest.mark.usefixtures("viewer")
def test_a_whole_page_holds_the_two_files_and_allows_no_other_code(tmp_path: Path) -> None:
    path = tmp_path / "match.wsr"
    match = Match(MatchSpec(track="battle", map=SMALL_MAP, seats=("walker", "walker"), time_limit=2.0))
    match.play_out()
    write_record(path, match, [HOSTILE, f"<!--{HOSTILE}"])

    scene = scene_of(path)
    page = Elements(whole_page(scene))

    assert HOSTILE in scene.title
    data = {attributes["id"]: base64.b64decode(text) for attributes, text in page.called("script")[:2]}
    assert data == {"wildscav-map": scene.map, "wildscav-trails": scene.trails}
    assert len(page.called("script")) == 3
    (code,) = (text for attributes, text in page.called("script") if attributes.get("type") == "module")
    (style,) = (text for _, text in page.called("style"))
    policy = str(page.called("meta")[1][0]["content"])
    for kind, text in (("script", code), ("style", style)):
        digest = base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()
        assert f"{kind}-src 'sha256-{digest}'" in policy
    assert code == SCRIPT.replace("</", "<\\/").replace("<!", "<\\!")  # the same string to JavaScript
    assert "unsafe" not in policy
    assert page.comments == [f"\n{LEGAL.replace('--', '- -')}\n"]
    assert page.called("h1")[0][1] == scene.title


@pytest.mark.usefixtures("viewer")
def test_pages_of_a_site_ask_it_for_everything() -> None:
    page = Elements(match_page(Shown("A & B", "/matches/3")))

    (stage,) = (attributes for attributes, _ in page.called("div"))
    assert (stage["data-map"], stage["data-trails"]) == ("/matches/3/map", "/matches/3/trails")
    (code,) = (attributes for attributes, _ in page.called("script"))
    assert re.fullmatch(r"/stage/viewer\.js\?v=[0-9a-f]{16}", str(code["src"]))
    assert page.called("h1")[0][1] == "A & B"


@pytest.mark.usefixtures("viewer")
def test_two_matches_are_on_one_page() -> None:
    page = Elements(match_page(Shown("A & B", "/matches/3"), Shown(HOSTILE, "/matches/4")))

    pair, one, other = (attributes for attributes, _ in page.called("div"))
    assert pair == {"class": "player-pair"}
    assert (one["data-map"], other["data-map"]) == ("/matches/3/map", "/matches/4/map")
    assert (one["data-title"], other["data-title"]) == ("A & B", HOSTILE)
    assert ("data-with" in one, "data-with" in other) == (False, True)
    assert len(page.called("script")) == 1


def test_a_list_has_names_as_text() -> None:
    page = Elements(list_page("Matches", [(HOSTILE, "/matches/0")]))
    assert [text for _, text in page.called("a")] == [HOSTILE]
    assert page.called("script") == []


def test_without_a_viewer_it_is_said_how_to_build_it(viewer: Path) -> None:
    (viewer / "viewer.css").unlink()
    for make in (lambda: match_page(Shown("", "")), lambda: whole_page(Scene("", b"", b""))):
        with pytest.raises(UserError, match=r"viewer\.css is missing: run make viewer"):
            make()


def test_what_is_no_record_is_one_clear_error(tmp_path: Path) -> None:
    broken = tmp_path / "broken.wsr"
    broken.write_bytes(b"nothing")
    for path in (broken, tmp_path / "none.wsr", tmp_path):
        with pytest.raises(UserError, match=path.name):
            scene_of(path)


def test_the_title_says_who_plays_and_not_who_wins(record_of_track: Records) -> None:
    scene = scene_of(record_of_track("battle"))
    assert scene.title == "Supply battle: submission 0, fighter 1, fighter 2, fighter 3"
