"""Boards and matches as tables for spreadsheets."""

import csv
import io
from collections.abc import Iterable, Sequence

from wildscav_leaderboard.boards.documents import BoardDocument, LadderRow, Row, SuiteRow
from wildscav_leaderboard.publishing.documents import PublishedMatch

PLACE = (
    *("rank", "last_rank", "team", "team_title", "submission", "name", "version"),
    *("matches", "planned", "faults", "since"),
)
RATING = ("rating", "deviation", "low", "high", "provisional", "wins", "mean_place")
STATISTICS = ("mean", "std", "low", "high")
MATCH = ("match", "kind", "number", "at", "record", "void")
SEAT = ("seat", "entrant", "submission", "status", "fault")


def board_table(board: BoardDocument) -> str:
    """Return a board as CSV, a row for each team."""
    metrics = [one.name for one in board.metrics]
    if board.mode == "ladder":
        columns: tuple[str, ...] = RATING
    else:
        columns = tuple(f"{name} {statistic}" for name in metrics for statistic in STATISTICS)
    rows = [[*(getattr(row, name) for name in PLACE), *_values(row, metrics)] for row in board.rows]
    return _text((*PLACE, *columns), rows)


def _values(row: Row, metrics: Sequence[str]) -> list[object]:
    if isinstance(row, LadderRow):
        return [getattr(row, name) for name in RATING]
    if not isinstance(row, SuiteRow) or not row.metrics:
        return []
    return [getattr(row.metrics[name], statistic) for name in metrics for statistic in STATISTICS]


def matches_table(matches: Sequence[PublishedMatch]) -> str:
    """Return matches as CSV, a row for each seat of an entrant."""
    names = list(dict.fromkeys(name for match in matches for seat in match.seats for name in seat.metrics))
    rows: list[list[object]] = []
    for match in matches:
        own: list[object] = [match.id, match.kind, match.number, match.at, match.record, match.void]
        rows += [
            [*own, *(getattr(seat, name) for name in SEAT), *(seat.metrics.get(name) for name in names)]
            for seat in match.seats
        ] or [own]
    return _text((*MATCH, *SEAT, *names), rows)


def _text(columns: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    output = io.StringIO()
    writer = csv.writer(output, lineterminator="\n")
    writer.writerow(columns)
    writer.writerows([_cell(value) for value in row] for row in rows)
    return output.getvalue()


def _cell(value: object) -> object:
    """Return a cell that no spreadsheet takes for a formula: people give names to teams and submissions."""
    return f"'{value}" if isinstance(value, str) and value[:1] in "=+-@" and value else value
