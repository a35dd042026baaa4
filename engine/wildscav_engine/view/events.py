"""The events of a match as text: pick-ups, hits, deaths, respawns, the target."""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
import rerun as rr

from wildscav_engine.simulation.state import NOBODY, NOT_ELIMINATED
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
    """Return all events in chronological order.

    Args:
        opening: The text of the first event.
        ending: The text of the last event.
    """
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
    agents = history.agents
    for row, seat in seats_where(agents.fired & (agents.hit_seat != NOBODY)):
        victim = int(agents.hit_seat[row, seat])
        text = f"{names[seat]} hits {names[victim]}, {agents.health[row, victim]} hp left"
        yield Event(row, "HIT", text, colors.HURT)


def _deaths(history: History, names: Sequence[str], *, kills_first: bool = False) -> Iterator[Event]:
    """Yield deaths; with ``kills_first``, the text starts with the killer and has its team's colour."""
    agents = history.agents
    died = np.diff(agents.deaths, axis=0, prepend=agents.deaths[:1]) > 0
    for row, seat in seats_where(died):
        by = int(agents.hit_by_seat[row, seat])
        out = agents.eliminated[row, seat] != NOT_ELIMINATED
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
    reached = np.nonzero(history.reached_by != NOBODY)[0]
    if len(reached):
        seat = int(history.reached_by[reached[0]])
        yield Event(int(reached[0]), "TARGET", f"{names[seat]} reaches the target", colors.GOAL)


KINDS = (_pick_ups, _hits, _deaths, _respawns, _goals)
