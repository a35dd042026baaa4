"""The boards of a season as tables, for ``wildscav leaderboard --season``."""

from typing import TYPE_CHECKING

from rich.text import Text

from wildscav.errors import UserError
from wildscav.terminal.console import console, print_json, printable
from wildscav.terminal.suggestions import did_you_mean

if TYPE_CHECKING:
    from collections.abc import Sequence

    from wildscav.terminal.tables import FittingTable
    from wildscav_leaderboard.api.documents import SeasonView
    from wildscav_leaderboard.boards.columns import Column
    from wildscav_leaderboard.boards.documents import BoardDocument, Row

PARTS = ("used_time", "punish_time")  # metrics whose sum is the score: narrow terminals show the sum alone
LEGEND = (
    "A range of ranks starts below the teams that are better with 95 % confidence, and ends above the worse."
)


def show_boards(named: str, track: str | None, *, as_json: bool) -> None:
    """Print the boards of a season: of one track, or of all.

    Raises:
        UserError: The season has no such track, or does not answer.
    """
    from wildscav_leaderboard.competing.connected import season_client

    with season_client(named) as client:
        season, found = client.season(), client.boards()
    names = [one.name for one in season.tracks]
    if track is not None and not any(name.startswith(track) for name in names):
        near = did_you_mean(track, names)
        raise UserError(f"{season.title} has no track {track}{near}; it has {', '.join(names)}")
    found = [one for one in found if track is None or one.track.startswith(track)]
    if as_json:
        print_json({"season": season, "boards": found})
    _print(season, found)


def _print(season: "SeasonView", found: "list[BoardDocument]") -> None:
    from wildscav_leaderboard.boards.columns import columns_of

    for board in found:
        if not board.rows:
            title = f"{board.track} · suite {board.conditions.suite}: nobody takes part yet\n"
            console.print(Text(printable(title), "bold"))
            continue
        columns = columns_of(board)
        table = _table(board, columns)
        if not table.fits(console):
            table = _table(
                board, [one for one in columns if one.metric is None or one.metric.name not in PARTS]
            )
        console.print(table)
        console.print(f"played by {board.conditions.versions}\n")
    if not found:
        console.print(f"There are no results in {printable(season.title)} yet.")
        return
    if season.frozen and not season.finalized:
        console.print("The boards are frozen until the season is over.")
    console.print(LEGEND, style="dim")


def _table(board: "BoardDocument", columns: "Sequence[Column]") -> "FittingTable":
    from wildscav_evaluator.cli.result_tables import add_columns, heading, plain_table
    from wildscav_evaluator.scores.number_format import NOTHING

    title = f"{board.track} · suite {board.conditions.suite} · {board.updated:%Y-%m-%d %H:%M} UTC"
    table = plain_table(printable(title))
    add_columns(table, "ranks")
    table.add_column("team", vertical="bottom", min_width=12)
    table.add_column("submission", vertical="bottom", min_width=12)
    for one in columns:
        narrow = one.title.replace("% ", "%\n").replace("mean ", "mean\n")
        add_columns(table, narrow if one.metric is None else heading(one.metric))
    for row in board.rows:
        what = "" if row.submission is None else f"{row.submission}: {row.agent}"
        who = (row.ranks or NOTHING, printable(row.team_title or row.team or row.name), printable(what))
        table.add_row(*map(Text, who), *(_cell(column, row) for column in columns))
    return table


def _cell(column: "Column", row: "Row") -> Text:
    from wildscav_evaluator.scores.number_format import NOTHING

    text = column.text(row) or (NOTHING if row.rank is None or column.metric else "")
    if column.kind == "interval" and column.note(row):
        text = f"{text}\n{column.note(row)}"
    style = "bold" if column.kind == "main" else "red" if column.kind == "faults" and row.faults else ""
    return Text(text, style)
