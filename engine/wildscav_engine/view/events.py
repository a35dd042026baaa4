"""The events of a match as text: pick-ups, hits, deaths, respawns, the target."""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
import rerun as rr

from wildscav_engine.simulation.state import NOBODY
from wildscav_engine.view.recording import colors
from wildscav_engine.view.recording.columns import Columns
from wildscav_engine.view.recording.history import History, seats_where

EVENTS, KILLS = "events", "kills"  # entity paths


class Event(NamedTuple):
    """One line of the log."""

    row: int
    kind: str
    text: str
    color: colors.Color


def events_of(
    history: History,
    names: Sequence[str],
    opening: str = "The match begins",
    ending: str = "The match is over",
) -> list[Event]:
    """Return all events in chronological order, between one each for the start and the end."""
    events = [
        *(event for find_events in KINDS for event in find_events(history, names)),
        Event(0, "START", opening, colors.START_END),
        Event(int(history.rows[-1]), "END", ending, colors.START_END),
    ]
    # Events of the same step are in the order of KINDS, between the start and the end.
    return sorted(events, key=lambda event: (event.row, event.kind == "END", event.kind != "START"))


def kills_of(history: History, names: Sequence[str]) -> list[Event]:
    """Return the kills in chronological order, in the colour of the killer's team."""
    return list(_deaths(history, names, kills_first=True))


def event_columns(path: str, events: Sequence[Event]) -> Columns:
    """Return events as the columns of a text log."""
    rows = np.array([event.row for event in events], np.int64)
    values = rr.TextLog.columns(
        text=[event.text for event in events],
        level=[event.kind for event in events],
        color=[event.color for event in events],
    )
    return Columns(path, rows, values)


def _pick_ups(history: History, names: Sequence[str]) -> Iterator[Event]:
    agents = history.agents
    for row, seat in seats_where(agents.gained > 0):
        text = f"{names[seat]} picks up {agents.gained[row, seat]}, has {agents.supplies[row, seat]}"
        yield Event(row, "PICK-UP", text, colors.PICK_UP)


def _hits(history: History, names: Sequence[str]) -> Iterator[Event]:
    for row, seat, victim in history.hits():
        text = f"{names[seat]} hits {names[victim]}, {history.agents.health[row, victim]} hp left"
        yield Event(row, "HIT", text, colors.HURT)


def _deaths(history: History, names: Sequence[str], *, kills_first: bool = False) -> Iterator[Event]:
    """Yield deaths; with ``kills_first``, the text starts with the killer and has its team's colour."""
    for row, seat, by, out in history.deaths():
        end, kind = ("is out", "OUT") if out else ("dies", "DEATH")
        if kills_first and by != NOBODY:
            text = f"{names[by]} shoots {names[seat]}{', who is out' if out else ''}"
            yield Event(row, "KILL", text, colors.team_color(history.team_of(by)))
        else:
            text = f"{names[seat]} {end}{'' if by == NOBODY else f', shot by {names[by]}'}"
            yield Event(row, kind, text, colors.DEATH)


def _respawns(history: History, names: Sequence[str]) -> Iterator[Event]:
    alive = history.agents.health > 0
    for row, seat in seats_where(alive[1:] & ~alive[:-1]):
        yield Event(row + 1, "RESPAWN", f"{names[seat]} is back", colors.RESPAWN)


def _goals(history: History, names: Sequence[str]) -> Iterator[Event]:
    arrival = history.arrival()
    if arrival is not None:
        row, seat = arrival
        yield Event(row, "TARGET", f"{names[seat]} reaches the target", colors.GOAL)


KINDS = (_pick_ups, _hits, _deaths, _respawns, _goals)
