"""The standings of a match at every moment, as a table, and its outcome in one sentence."""

from collections.abc import Callable, Iterator, Sequence
from typing import NamedTuple

import numpy as np
import rerun as rr
from numpy.typing import NDArray

from wildscav_engine.record import Record
from wildscav_engine.simulation.state import NOT_OUT
from wildscav_engine.specs.actions import Field
from wildscav_engine.specs.rules import FRAMES_PER_SECOND
from wildscav_engine.tracks import TRACKS
from wildscav_engine.view.recording.columns import Columns
from wildscav_engine.view.recording.history import History, changes
from wildscav_engine.view.verdict import clock, verdict

PATH = "standings"
MOST_LINES = 12  # agents in the table; the followed one is always among them


class Column(NamedTuple):
    """A column of the table."""

    title: str
    values: NDArray[np.generic]  # (T + 1, A)
    write: Callable[[float], str] = lambda value: f"{value:.0f}"
    steady: bool = True  # whether a change is worth a new table at once; else it waits for the next second


class Table(NamedTuple):
    """What is needed to write the standings at any row."""

    title: str
    time_limit: float  # s
    names: tuple[str, ...]
    columns: tuple[Column, ...]
    keys: tuple[NDArray[np.generic], ...]  # (T + 1, A) each, what seats are ranked by, the most telling first
    followed: int
    outcome: str


def static_standings() -> Iterator[tuple[str, rr.AsComponents]]:
    """Yield that the table is Markdown."""
    yield PATH, rr.TextDocument.from_fields(media_type="text/markdown")


def moving_standings(record: Record, history: History, names: Sequence[str], followed: int) -> Columns:
    """Return the table wherever it changes, and each second for its clock."""
    table = _table(record, history, tuple(names), followed)
    last = int(history.rows[-1])
    seconds = np.nonzero(np.diff(history.frame // FRAMES_PER_SECOND, prepend=-1))[0]
    steady = [column.values for column in table.columns if column.steady]
    rows = np.union1d(changes(history.frame * 0, *steady), np.union1d(seconds, [last]))
    texts = [_page(table, row, int(history.frame[row]), row == last) for row in rows.tolist()]
    return Columns(PATH, rows, rr.TextDocument.columns(text=texts))


def _table(record: Record, history: History, names: tuple[str, ...], followed: int) -> Table:
    agents, spec = history.agents, record.spec
    track = TRACKS[spec.track]
    columns: list[Column] = []
    keys: list[NDArray[np.generic]] = []
    if history.has_teammates:
        columns.append(Column("Team", np.broadcast_to(history.teams + 1, agents.health.shape)))
    if history.target is not None:
        columns.append(Column("Distance", history.distance_to_target, _metres, False))
        keys.append(history.distance_to_target)
    if not track.respawns:
        out = agents.eliminated != NOT_OUT
        keys += [out, -np.where(out, agents.eliminated, 0)]
    if track.has_supplies:
        keys += [-history.supplies_of_team, history.teams + 0 * agents.supplies, -agents.supplies]
        if history.has_teammates:
            columns.append(Column("Team has", history.supplies_of_team))
        columns.append(Column("Supplies", agents.supplies))
    if Field.SHOOT in track.fields:
        columns += [Column("Kills", agents.kills), Column("Deaths", agents.deaths)]
        columns.append(Column("Health", agents.health, _health, False))
    # In a track without anything to be ordered by during the match, seats stand in their order.
    keys.append(np.broadcast_to(np.arange(len(names)), agents.health.shape))
    return Table(
        track.title,
        spec.time_limit,
        names,
        tuple(columns),
        tuple(keys),
        followed,
        verdict(record.result, names),
    )


def _page(table: Table, row: int, frame: int, over: bool) -> str:
    """Return the Markdown of one row of the history."""
    time = f"{clock(frame)} of {clock(round(table.time_limit * FRAMES_PER_SECOND))}"
    story = f"**{_plain(table.outcome)}**" if over else f"**{time}**"
    order = np.lexsort([key[row] for key in reversed(table.keys)]).tolist()
    places = {seat: place for place, seat in enumerate(order, start=1)}
    shown = order[:MOST_LINES]
    if table.followed not in shown:
        shown[-1] = table.followed
    lines = [
        f"# {table.title}",
        "",
        story,
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


def _metres(distance: float) -> str:
    return f"{distance:.0f} m"


def _health(left: float) -> str:
    return f"{left:.0f}" if left > 0 else "dead"


def _plain(text: str) -> str:
    """Return text that Markdown shows as it stands: names are made by competitors and may be anything."""
    return "".join(
        f"\\{sign}" if sign in "\\`*_{}[]()<>#+-.!|~&$:" else sign for sign in " ".join(text.split())
    )
