"""Who may read what agents said in a match: their team, and others as far as it is public and not hidden."""

from collections.abc import Callable, Iterator

import httpx
import pytest
from tests.leaderboard.filled_season import FilledSeason
from tests.leaderboard.hosting.clients import ask
from tests.leaderboard.spectating.served import served

from wildscav.notes import note_line
from wildscav_leaderboard.hosting.app import create_app

Ask = Callable[..., httpx.Response]


@pytest.fixture
def of_ladder(new_filled_season: Callable[..., FilledSeason]) -> Iterator[Ask]:
    """Ask for something below a match of a ladder, of whose agent one note is public."""
    filled = new_filled_season()
    number = filled.matches["ladder"]
    log = filled.season.match_folder(number) / "seat.log"
    log.write_text(note_line(3, say="Good luck!", public=True) + note_line(4, say="He is slow."))
    app = create_app(filled.season, filled.database)
    with served(app) as address, httpx.Client(base_url=address, timeout=60.0) as client:
        yield lambda who, method, path, **more: ask(
            client, filled, who, method, path.format(number=number), **more
        )
    app.state.renders.close()
    filled.database.close()


def said(answer: httpx.Response) -> set[str]:
    return {note["text"] for note in answer.json()["notes"]}


def test_others_read_what_is_public_until_an_organizer_hides_it(of_ladder: Ask) -> None:
    notes, acts = "/api/v1/matches/{number}/notes", "/api/v1/organizer/matches/{number}"
    assert said(of_ladder("visitor", "GET", notes)) == {"Good luck!"}
    assert said(of_ladder("organizer", "GET", notes)) == {"Good luck!", "He is slow."}
    assert 'data-notes="/api/v1/matches/' in of_ladder("visitor", "GET", "/matches/{number}").text

    of_ladder("organizer", "POST", f"{acts}/hide", body={"reason": "an insult"}).raise_for_status()
    assert said(of_ladder("visitor", "GET", notes)) == set()
    assert said(of_ladder("organizer", "GET", notes)) == {"Good luck!", "He is slow."}
    of_ladder("organizer", "POST", f"{acts}/unhide").raise_for_status()
    assert said(of_ladder("visitor", "GET", notes)) == {"Good luck!"}
    assert of_ladder("organizer", "POST", f"{acts}/unhide").status_code == 409
