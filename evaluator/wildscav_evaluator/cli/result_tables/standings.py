"""The tables of a tournament: the standings, and who won against whom."""

from rich.table import Table
from rich.text import Text

from wildscav_evaluator.cli.result_tables.ranking import add_columns, fault_cell, heading, plain_table
from wildscav_evaluator.ratings.standings import Standing
from wildscav_evaluator.scores.number_format import NOTHING, number
from wildscav_evaluator.tournaments.tournament_file import Tournament

MAX_OPPONENTS = 8  # in the table of pairs; the picture and the file have all
MAX_ROWS = 100  # of the standings; the file has all
LETTERS = 26
LEGEND = (
    "Entrants that share a letter cannot be told apart. Ratings are on the scale of Elo: 400 more are odds "
    "of 10 : 1. Wins are first places, + shared ones."
)
GROUPS = (
    " The entrants form {} groups that never met each other: ratings, ranks and letters can be compared only "
    "within a group. More --rounds or --seats connect them."
)


def legend(tournament: Tournament) -> str:
    """Return the explanation of the standings, which names the groups if there are several."""
    groups = len({one.group for one in tournament.ratings.standings})
    return LEGEND + (GROUPS.format(groups) if groups > 1 else "")


def standings_table(tournament: Tournament) -> Table:
    """Return the standings: every entrant from best to worst."""
    standings, entries = tournament.ratings.standings, {one.name: one for one in tournament.entrants}
    failed = any(one.faults for one in tournament.entrants)
    table = plain_table(tournament.title)
    add_columns(table, "ranks", "bands")
    table.add_column("entrant", vertical="bottom", min_width=12)
    add_columns(table, "rating\n± 95 %", "matches", "wins", "mean\nplace")
    add_columns(table, heading(tournament.score), *(["failed"] if failed else []))
    for one in standings[:MAX_ROWS]:
        entry = entries[one.entrant]
        table.add_row(
            one.ranks,
            "".join(map(letters, one.bands)),
            one.entrant,
            Text.assemble((f"{one.rating:.0f}", "bold"), _interval(one)),
            f"{one.matches:,}",
            one.first_places,
            f"{one.mean_place:.2f}",
            NOTHING if entry.score is None else number(entry.score.mean, tournament.score),
            *([fault_cell(entry.faults, one.matches)] if failed else []),
        )
    if len(standings) > MAX_ROWS:
        table.caption = f"and {len(standings) - MAX_ROWS:,} more"
    return table


def _interval(one: Standing) -> str:
    """Return half the width of a rating's interval, which is symmetric; nothing after a single game."""
    return "" if one.low is None or one.high is None else f" ±{(one.high - one.low) / 2:.0f}"


def pairs_table(tournament: Tournament) -> Table:
    """Return who was placed better than whom: wins, ties and losses of the row against the column."""
    names = [one.entrant for one in tournament.ratings.standings][:MAX_OPPONENTS]
    found = {}
    for pair in tournament.ratings.pairs:
        found[pair.first, pair.second] = (pair.wins, pair.ties, pair.losses)
        found[pair.second, pair.first] = (pair.losses, pair.ties, pair.wins)
    table = plain_table("better places – ties – worse places, of the row against the column")
    table.add_column("", min_width=10)
    add_columns(table, *(str(number) for number in range(1, len(names) + 1)))
    for place, name in enumerate(names, start=1):
        cells = [
            ""
            if name == other
            else "–".join(map(str, found[name, other]))
            if (name, other) in found
            else NOTHING
            for other in names
        ]
        table.add_row(f"{place} {name}", *cells)
    return table


def letters(number: int) -> str:
    """Return the letter of a band, which is numbered from 1: a to z, then z2 and so on."""
    return chr(ord("a") + number - 1) if number <= LETTERS else f"z{number - LETTERS + 1}"
