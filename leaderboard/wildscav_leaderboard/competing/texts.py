"""How commands show what a season answers. Much of it is text of others, and none may control a terminal."""

from collections.abc import Mapping
from datetime import UTC, datetime
from typing import TYPE_CHECKING

from rich.table import Table
from rich.text import Text

from wildscav.terminal.console import console, counted, printable
from wildscav.terminal.tables import FittingTable

if TYPE_CHECKING:
    from wildscav_leaderboard.api.documents import MatchView, QuotaView, SeatView, SubmissionView
    from wildscav_leaderboard.boards.documents import ProgressView, TotalsView

STATE_STYLES = {
    "active": "green",
    "finished": "green",
    "failed": "bold red",
    "cancelled": "dim",
    "disabled": "dim",
}
NOTHING = "-"


def say(text: str) -> None:
    """Print one line, however long it is."""
    console.print(Text(printable(text)))


def facts(rows: Mapping[str, str | Text]) -> Table:
    """Return a table of names and values; rows without a value are left out."""
    table = Table.grid(padding=(0, 2))
    table.add_column(style="dim", no_wrap=True)
    table.add_column(overflow="fold")
    for name, value in rows.items():
        if value:
            table.add_row(name, value if isinstance(value, Text) else Text(printable(value)))
    return table


def table_of(title: str, *headings: str) -> FittingTable:
    """Return an empty table; columns are of text, and those whose heading ends in # of numbers."""
    table = FittingTable(printable(title))
    for heading in headings:
        if heading.endswith("#"):
            table.add_column(heading[:-1] or "#", justify="right", no_wrap=True)
        else:
            table.add_column(heading)
    return table


def row(*cells: object) -> list[Text]:
    """Return the cells of a row, each on one line."""
    return [cell if isinstance(cell, Text) else Text(printable(str(cell))) for cell in cells]


def moment(time: datetime) -> str:
    """Return a time of UTC."""
    return f"{time.astimezone(UTC):%Y-%m-%d %H:%M:%S}"


def minute(time: datetime) -> str:
    """Return a time of UTC for a list, without its year and seconds."""
    return f"{time.astimezone(UTC):%m-%d %H:%M}"


def duration(seconds: float) -> str:
    """Return about how long something takes."""
    if seconds < 90:
        return f"{seconds:.0f} s"
    return f"{seconds / 60:.0f} min" if seconds < 5400 else f"{seconds / 3600:.1f} h"


def state(text: str) -> Text:
    """Return a state in its colour."""
    return Text(printable(text), STATE_STYLES.get(text, ""))


def waiting(one: "SubmissionView") -> str:
    """Return where a submission is in the queue, how far its validation is, and about how long it takes."""
    parts = [] if one.queue_position is None else [f"number {one.queue_position} in the queue"]
    parts += [one.validation] if one.validation else []
    if one.expected_wait:  # not one that takes longer than expected
        parts.append(f"about {duration(one.expected_wait)}")
    return ", ".join(parts)


def team(name: str, title: str) -> str:
    """Return a team as people read it, with the name that commands and addresses use."""
    return name if title == name else f"{title} ({name})"


def quota(one: "QuotaView") -> str:
    """Return what is left of a quota."""
    return (
        f"{one.left_today} of {counted(one.per_day, 'submission')} left today; the next day begins at "
        f"{one.resets.astimezone(UTC):%Y-%m-%d %H:%M} UTC; {counted(one.active_per_track, 'submission')} "
        "of a team may take part at once on each track"
    )


def waits_for(missing: int) -> str:
    """Return what a ladder waits for that has too few entrants."""
    teams, verb = ("1 more team", "takes") if missing == 1 else (f"{missing} more teams", "take")
    return f"its ladder makes no matches before {teams} {verb} part"


def standing(one: "ProgressView") -> str:
    """Return how far a submission is on a track."""
    if one.missing:
        return waits_for(one.missing)
    return f"{one.played:,} of {counted(one.planned, 'match')} played"


def totals(one: "TotalsView") -> str:
    """Return how a submission did in all matches of a suite, and how to find its faults."""
    parts = [f"mean {one.score:.4g} in {counted(one.matches, 'match')}"]
    parts += [f"{count} {name.replace('_', ' ')}" for name, count in one.faults.items()]
    hint = f" (`wildscav evaluate DIR --track {one.track}` plays on public seeds)" if one.faults else ""
    return ", ".join(parts) + hint


def figures(metrics: Mapping[str, float] | None) -> str:
    """Return the figures of a seat."""
    return ", ".join(f"{name} {value:.4g}" for name, value in (metrics or {}).items())


def outcome(match: "MatchView", seat: "SeatView") -> str:
    """Return how a match ended for a seat, as far as it is known."""
    if seat.status is None:
        return "hidden" if match.state == "finished" and match.unseen else ""
    status = "" if seat.status == "finished" and seat.metrics else seat.status
    return " · ".join(filter(None, (status, figures(seat.metrics))))
