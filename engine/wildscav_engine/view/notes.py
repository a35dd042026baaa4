"""What agents said and drew beside their play, in a replay: texts in the log of events, marks, and plots."""

from collections.abc import Iterator, Sequence

import numpy as np
import rerun as rr

from wildscav_engine.view.events import Event
from wildscav_engine.view.recording import colors, coordinates
from wildscav_engine.view.recording.agent_notes import Note
from wildscav_engine.view.recording.columns import Columns
from wildscav_engine.view.recording.history import History

MARKS, PLOTS = "marks", "plots"  # entity paths, under which each mark and each quantity has one of its own
RADIUS = 0.25  # m


def said(notes: Sequence[Note], history: History, names: Sequence[str]) -> list[Event]:
    """Return what agents said as events, in the colours of their teams."""
    team_colors = [colors.team_color(team) for team in history.teams.tolist()]
    return [
        Event(note.step, "SAYS", f"{names[note.seat]}: {note.text}", team_colors[note.seat])
        for note in notes
        if note.text
    ]


def drawn(notes: Sequence[Note], history: History) -> Iterator[Columns]:
    """Yield the marks and the plotted quantities of all agents."""
    series: dict[tuple[int, str, bool], dict[int, Note]] = {}
    for note in notes:
        if note.name:  # of several in one step, the last counts
            series.setdefault((note.seat, note.name, note.value is None), {})[note.step] = note
    for (seat, name, is_mark), by_step in series.items():
        rows = np.array(sorted(by_step), np.int64)
        some = [by_step[row] for row in rows.tolist()]
        path = f"{MARKS if is_mark else PLOTS}/seat_{seat}/{rr.escape_entity_path_part(name)}"
        if is_mark:
            yield from _mark(path, rows, some, history)
        else:
            values = np.array([note.value for note in some], np.float64)
            yield Columns(path, rows, rr.Scalars.columns(scalars=values))


def _mark(path: str, rows: np.ndarray, notes: Sequence[Note], history: History) -> Iterator[Columns]:
    """Yield a mark as a line with its points; a removed one has none."""
    color = colors.team_color(history.team_of(notes[0].seat))
    strips = [coordinates.points(np.array(note.points, np.float64).reshape(-1, 3)) for note in notes]
    lengths = [len(strip) for strip in strips]
    everything = np.concatenate(strips)
    points = rr.Points3D.columns(
        positions=everything,
        colors=[color] * len(everything),
        radii=[RADIUS] * len(everything),
        labels=[notes[0].name] * len(everything),
    )
    yield Columns(f"{path}/points", rows, points.partition(lengths))
    lines = rr.LineStrips3D.columns(
        strips=[strip for strip in strips if len(strip) > 1],
        colors=[color] * sum(length > 1 for length in lengths),
    )
    yield Columns(f"{path}/line", rows, lines.partition([int(length > 1) for length in lengths]))
