"""The boards of a demo season, as they were when its matches had been played."""

from pydantic import TypeAdapter

from wildscav_engine.tracks import TRACKS
from wildscav_leaderboard.boards.documents import BoardDocument, LadderBoard, Row, place_of
from wildscav_website.links import ROOT
from wildscav_website.markdown import sentence, table

BOARDS = ROOT / "docs" / "examples" / "demo_season.json"
OPENING = """# A demo season

These are the boards of the season that `wildscav season demo` opens on your machine in a minute, with pages
of all its teams and matches, and accounts to try it. [Organizing a season](organizing.md) opens your own.
"""


def boards() -> list[BoardDocument]:
    """Return the boards as the season's API gave them (``docs/images/board.py``)."""
    return TypeAdapter(list[BoardDocument]).validate_json(BOARDS.read_bytes())


def page() -> str:
    """Return the page."""
    return "\n".join([OPENING, *(_section(board) for board in boards())])


def _section(board: BoardDocument) -> str:
    what = "Rating" if isinstance(board, LadderBoard) else board.metrics[0].title
    head = ("Rank", "Team", "Submission", sentence(what).rstrip("."), "95 % interval", "Matches")
    rows = [_cells(board, row) for row in board.rows]
    return f"## {TRACKS[board.track].title}\n\n{table(head, rows)}"


def _cells(board: BoardDocument, row: Row) -> tuple[str, ...]:
    place, low, high = (f"{number:,.0f}" for number in place_of(board, row))
    submission = row.name if row.submission is None else f"{row.name} {row.version}"
    return row.ranks, row.team_title or "a robot", submission, place, f"{low} to {high}", str(row.matches)
