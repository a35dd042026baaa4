"""Who may read what agents said in a match: their team, and others as far as it is public and not hidden."""

import gzip
import json
from collections.abc import Callable, Iterator
from pathlib import Path

import httpx
import pytest
from tests.leaderboard.filled_season import FilledSeason
from tests.leaderboard.hosting.clients import serving_filled

from wildscav.notes import note_line
from wildscav_leaderboard.spectating import kept_notes
from wildscav_leaderboard.spectating.kept_notes import SeenLog, sent_notes

Ask = Callable[..., httpx.Response]


@pytest.fixture
def of_ladder(new_filled_season: Callable[..., FilledSeason]) -> Iterator[Ask]:
    """Ask for something below a match of a ladder, of whose agent one note is public."""
    filled = new_filled_season()
    number = filled.matches["ladder"]
    log = filled.season.match_folder(number) / "seat.log"
    log.write_text(note_line(3, say="Good luck!", public=True) + note_line(4, say="He is slow."))
    with serving_filled(filled) as site:
        yield lambda who, method, path, body=None: site.ask(
            who, path.replace("{number}", str(number)), method, body
        )


def said(answer: httpx.Response) -> set[str]:
    return {note["text"] for note in answer.json()["notes"]}


def test_others_read_what_is_public_until_an_organizer_hides_it(of_ladder: Ask) -> None:
    notes, acts = "/api/v1/matches/{number}/notes", "/api/v1/organizer/matches/{number}"
    assert said(of_ladder("visitor", "GET", notes)) == {"Good luck!"}
    assert said(of_ladder("organizer", "GET", notes)) == {"Good luck!", "He is slow."}
    assert 'data-notes="/api/v1/matches/' in of_ladder("visitor", "GET", "/matches/{number}").text

    of_ladder("organizer", "POST", f"{acts}/hide", body={"reason": "an insult"}).raise_for_status()
    assert "an insult" in of_ladder("visitor", "GET", "/matches/{number}").text
    assert said(of_ladder("visitor", "GET", notes)) == set()
    assert said(of_ladder("organizer", "GET", notes)) == {"Good luck!", "He is slow."}
    of_ladder("organizer", "POST", f"{acts}/unhide").raise_for_status()
    assert said(of_ladder("visitor", "GET", notes)) == {"Good luck!"}
    assert of_ladder("organizer", "POST", f"{acts}/unhide").status_code == 409


def test_a_team_reads_all_of_its_own_and_of_others_what_is_public(of_ladder: Ask) -> None:
    seats = of_ladder("visitor", "GET", "/api/v1/matches/{number}").json()["seats"]
    private = {}
    for who, team in {"owner": "owls", "opponent": "foxes", "other": "none"}.items():
        notes = of_ladder(who, "GET", "/api/v1/matches/{number}/notes").json()["notes"]
        assert {note["seat"] for note in notes if note["text"] == "Good luck!"} == {0, 1}
        private[who] = {note["seat"] for note in notes if note["text"] == "He is slow."}
        assert private[who] == {seat["seat"] for seat in seats if seat["team"] == team}
    assert private["owner"] | private["opponent"]


@pytest.mark.parametrize("who", ["visitor", "other", "owner"])
def test_nobody_reads_those_of_a_match_whose_record_is_hidden(of_ladder: Ask, who: str) -> None:
    assert of_ladder(who, "GET", "/api/v1/matches/{own_suite}/notes").status_code == 403


def test_a_log_is_read_again_only_when_it_has_changed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    log, most = SeenLog(tmp_path / "seat.log", 0, everything=True), 3
    monkeypatch.setattr(kept_notes, "MOST", most)

    def sent() -> tuple[bytes, int]:
        (content,) = sent_notes([log], 5)
        return content, len(json.loads(gzip.decompress(content))["notes"])

    assert sent()[1] == 0
    log.path.write_text(note_line(3, say="One"))
    first, count = sent()
    assert (sent()[0] is first, count) == (True, 1)
    log.path.write_text("".join(note_line(step, say="Many") for step in range(5)))
    assert sent()[1] == most
