"""The standings of a match over time as a table, and its outcome in one sentence."""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
import rerun as rr

from wildscav_engine.record import Record
from wildscav_engine.specs.actions import Field
from wildscav_engine.specs.rules import FRAMES_PER_SECOND
from wildscav_engine.tracks import TRACKS
from wildscav_engine.view.outcome import describe_outcome, format_time
from wildscav_engine.view.recording.columns import Columns
from wildscav_engine.view.recording.history import History, changes
from wildscav_engine.view.recording.ranking import Column, Keys, first_of, order_at, ranking_keys

PATH = "standings"
MAX_LINES = 12  # agents in the table, which always include the followed one


class Table(NamedTuple):
    """Everything that the standings of any row of the history depend on."""

    title: str
    time_limit: float  # s
    names: tuple[str, ...]
    columns: tuple[Column, ...]
    keys: Keys
    followed: int
    outcome: str


def static_standings() -> Iterator[tuple[str, rr.AsComponents]]:
    """Yield the media type of the table, which is Markdown."""
    yield PATH, rr.TextDocument.from_fields(media_type="text/markdown")


def moving_standings(record: Record, history: History, names: Sequence[str], followed: int) -> Columns:
    """Return the table in every row in which it changes, and in every second for its clock."""
    table = _table(record, history, tuple(names), followed)
    last = int(history.rows[-1])
    seconds = np.nonzero(np.diff(history.frame // FRAMES_PER_SECOND, prepend=-1))[0]
    immediate = [column.values for column in table.columns if column.immediate]
    rows = np.union1d(changes(history.frame * 0, *immediate), np.union1d(seconds, [last]))
    texts = [_page(table, row, int(history.frame[row]), row == last) for row in rows.tolist()]
    return Columns(PATH, rows, rr.TextDocument.columns(text=texts))


def _table(record: Record, history: History, names: tuple[str, ...], followed: int) -> Table:
    agents, spec = history.agents, record.spec
    track = TRACKS[spec.track]
    columns: list[Column] = []
    if history.has_teammates:
        columns.append(Column("Team", np.broadcast_to(history.teams + 1, agents.health.shape)))
    if history.target is not None:
        columns.append(Column("Distance", history.distance_to_target, "{:.0f} m".format, False))
    if track.has_supplies:
        if history.has_teammates:
            columns.append(Column("Team has", history.supplies_of_team))
        columns.append(Column("Supplies", agents.supplies))
    if Field.SHOOT in track.fields:
        columns += [Column("Kills", agents.kills), Column("Deaths", agents.deaths)]
        columns.append(
            Column("Health", agents.health, lambda left: f"{left:.0f}" if left > 0 else "dead", False)
        )
    return Table(
        track.title,
        spec.time_limit,
        names,
        tuple(columns),
        ranking_keys(track, history),
        followed,
        describe_outcome(record.result, names),
    )


def _page(table: Table, row: int, frame: int, over: bool) -> str:
    """Return the Markdown of one row of the history."""
    time = f"{format_time(frame)} of {format_time(round(table.time_limit * FRAMES_PER_SECOND))}"
    headline = f"**{_plain(table.outcome)}**" if over else f"**{time}**"
    order = order_at(table.keys, row)
    places = {seat: place for place, seat in enumerate(order, start=1)}
    shown = first_of(order, MAX_LINES, table.followed)
    lines = [
        f"# {table.title}",
        "",
        headline,
        "",
        "| # | Agent |" + "".join(f" {column.title} |" for column in table.columns),
        "|--:|:--|" + "--:|" * len(table.columns),
        *(_line(table, row, seat, places[seat]) for seat in shown),
    ]
    if len(order) > len(shown):
        lines += ["", f"and {len(order) - len(shown)} more"]
    return "\n".join(lines)


def _line(table: Table, row: int, seat: int, place: int) -> str:
    name = _plain(table.names[seat])
    cells = "".join(f" {column.write(float(column.values[row, seat]))} |" for column in table.columns)
    return f"| {place} | {f'**{name}**' if seat == table.followed else name} |{cells}"


def _plain(text: str) -> str:
    """Escape text for Markdown, because competitors choose the names."""
    return "".join(
        f"\\{character}" if character in "\\`*_{}[]()<>#+-.!|~&$:" else character
        for character in " ".join(text.split())
    )
