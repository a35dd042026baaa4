"""The boards of a season as tables, for ``wildscav leaderboard --season``."""

from typing import TYPE_CHECKING

from rich.text import Text

from wildscav.errors import UserError
from wildscav.terminal.console import console, print_json, printable
from wildscav.terminal.suggestions import did_you_mean

if TYPE_CHECKING:
    from rich.table import Table

    from wildscav_leaderboard.api.documents import SeasonView
    from wildscav_leaderboard.boards.documents import BoardDocument, LadderBoard, Row, SuiteBoard

LEGEND = "Teams whose ranks overlap cannot be told apart with 95 % confidence."


def show_boards(named: str | None, track: str | None, *, as_json: bool) -> None:
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
        boards = [one.model_dump(mode="json") for one in found]
        print_json({"season": season.model_dump(mode="json"), "boards": boards})
    _print(season, found)


def _print(season: "SeasonView", found: "list[BoardDocument]") -> None:
    for board in found:
        if not board.rows:
            title = f"{board.track} · suite {board.conditions.suite}: nobody takes part yet\n"
            console.print(Text(printable(title), "bold"), soft_wrap=True)
            continue
        console.print(_table(board))
        console.print(f"played by {board.conditions.versions}\n", soft_wrap=True)
    if not found:
        console.print(f"There are no results in {printable(season.title)} yet.")
        return
    if season.frozen and not season.finalized:
        console.print("The boards are frozen until the season is over.")
    console.print(LEGEND, style="dim")


def _table(board: "BoardDocument") -> "Table":
    from wildscav_evaluator.cli.result_tables import add_columns, plain_table

    title = f"{board.track} · suite {board.conditions.suite} · {board.updated:%Y-%m-%d %H:%M} UTC"
    table = plain_table(printable(title))
    add_columns(table, "ranks")
    table.add_column("team", vertical="bottom", min_width=12)
    table.add_column("submission", vertical="bottom", min_width=12)
    if board.mode == "suite":
        _fill_suite(table, board)
    else:
        _fill_ladder(table, board)
    return table


def _fill_suite(table: "Table", board: "SuiteBoard") -> None:
    from wildscav_evaluator.cli.result_tables import add_columns, add_metrics, metric_cells

    add_metrics(table, board.metrics)
    add_columns(table, "matches", "faults")
    for row in board.rows:
        table.add_row(*_who(row), *metric_cells(board.metrics, row.metrics), *_counts(row))


def _fill_ladder(table: "Table", board: "LadderBoard") -> None:
    from wildscav_evaluator.cli.result_tables import add_columns
    from wildscav_leaderboard.boards.documents import LADDER_COLUMNS

    titles = (column.title.replace(" ", "\n") for column in LADDER_COLUMNS.values())
    add_columns(table, "rating", "95 %\ninterval", *titles, "matches", "faults")
    for row in board.rows:
        # Before its first match an entrant has the rating with which all begin, which says nothing.
        rating = Text("" if row.rank is None else f"{row.rating:.0f}", "bold")
        interval = "" if row.rank is None else f"{row.low:.0f}–{row.high:.0f}"
        if row.rank is not None and row.provisional:
            interval += "\nprovisional"
        figures = (column.text(getattr(row, name)) for name, column in LADDER_COLUMNS.items())
        table.add_row(*_who(row), rating, interval, *figures, *_counts(row))


def _who(row: "Row") -> tuple[Text, Text, Text]:
    what = "" if row.submission is None else f"{row.submission}: {row.name} {row.version}"
    team = row.team_title or row.team or row.name
    return Text(row.ranks or "-"), Text(printable(team)), Text(printable(what))


def _counts(row: "Row") -> tuple[str, Text]:
    played = str(row.matches) if row.matches >= row.planned else f"{row.matches} of {row.planned}"
    return played, Text(str(row.faults), "red" if row.faults else "")
