"""How a replay is laid out when it is opened: the blueprint in the file."""

from typing import NamedTuple

import numpy as np
import rerun.blueprint as rrb
from numpy.typing import NDArray

from wildscav_engine.view import frame
from wildscav_engine.view.actors import path_of
from wildscav_engine.view.columns import MATCH_TIME, STEP
from wildscav_engine.view.follow import BEHIND, COLOR, DEPTH, EYES
from wildscav_engine.view.history import History

TRAIL_TIME, TRAIL_STEPS = 6.0, 60  # s; on the time line of steps
SKY = (150, 190, 225)
WHOLE_MAP = 150.0  # m, up to which the free view shows all of a map
NEAREST_FRAME, MARGIN = 60.0, 6.0  # m, least extent that it frames; around what moved
TITLES = {
    "distance": "Distance to the target",
    "supplies": "Supplies",
    "health": "Health",
    "ammo": "Ammunition",
}


class Layout(NamedTuple):
    """What the blueprint depends on besides the history."""

    names: tuple[str, ...]
    follow: int
    plots: tuple[str, ...]  # measures, the most telling first
    images: bool  # whether depth maps and pictures are in the file
    map_size: float  # m


def blueprint(history: History, layout: Layout) -> rrb.Blueprint:
    """Return the layout: the free view, two follow views, plots, the event log and what the agent sees."""
    name, followed = layout.names[layout.follow], path_of(layout.follow)
    follow_views: list[rrb.View] = [
        _spatial(f"Behind {name}", _follow_contents(BEHIND, f"/{followed}/name"), _eye_of(BEHIND)),
        _spatial(f"Eyes of {name}", _follow_contents(EYES, f"/{followed}/**"), _eye_of(EYES)),
    ]
    free = _spatial("Match", _free_contents(), _overview(history, layout.map_size), trails=len(layout.names))
    below: list[rrb.View | rrb.Container] = [_plots(layout), _log()]
    if layout.images:
        below.append(rrb.Spatial2DView(origin=COLOR, name=f"Camera of {name}"))
        below.append(rrb.Spatial2DView(origin=DEPTH, name=f"Depth map of {name}"))
    above = rrb.Horizontal(free, rrb.Vertical(*follow_views), column_shares=[2, 1])
    return rrb.Blueprint(
        rrb.Vertical(
            above, rrb.Horizontal(*below, column_shares=[4, 4, 3, 3][: len(below)]), row_shares=[5, 2]
        ),
        rrb.BlueprintPanel(state="collapsed"),
        rrb.SelectionPanel(state="collapsed"),
        rrb.TimePanel(state="collapsed", timeline=MATCH_TIME, play_state="playing"),
    )


def _spatial(name: str, contents: list[str], eye: rrb.EyeControls3D, trails: int = 0) -> rrb.Spatial3DView:
    return rrb.Spatial3DView(
        origin="/",
        name=name,
        contents=contents,
        eye_controls=eye,
        background=SKY,
        line_grid=False,
        overrides={f"trails/seat_{seat}": _trail() for seat in range(trails)},
    )


def _trail() -> rrb.VisibleTimeRanges:
    """Return how much of a way is seen: the last few seconds, whichever time line is looked at."""
    seconds = rrb.TimeRangeBoundary.cursor_relative(seconds=-TRAIL_TIME)
    steps = rrb.TimeRangeBoundary.cursor_relative(seq=-TRAIL_STEPS)
    now = rrb.TimeRangeBoundary.cursor_relative(seq=0)
    return rrb.VisibleTimeRanges(
        [
            rrb.VisibleTimeRange(MATCH_TIME, start=seconds, end=now),
            rrb.VisibleTimeRange(STEP, start=steps, end=now),
        ]
    )


def _free_contents() -> list[str]:
    return ["+ /**", "- /follow/**", "- /events"]


def _follow_contents(camera: str, hidden: str) -> list[str]:
    """Everything and one camera; the followed agent's name, or from its eyes all of it, is not seen."""
    return ["+ /**", "- /follow/**", f"+ /{camera}", "- /trails/**", "- /events", f"- {hidden}"]


def _eye_of(camera: str) -> rrb.EyeControls3D:
    return rrb.EyeControls3D(tracking_entity=f"/{camera}")


def _overview(history: History, map_size: float) -> rrb.EyeControls3D:
    """Look from the south-west, from above: at the whole map, or on a large one at all that moves."""
    low, high = _extent(history)
    if map_size <= WHOLE_MAP:
        low[[0, 2]], high[[0, 2]] = -map_size / 2, map_size / 2
    middle = (low + high) / 2
    extent = max(NEAREST_FRAME, float(high[0] - low[0]), float(high[2] - low[2])) + 2 * MARGIN
    eye = middle + extent * np.array([-0.27, 0.48, -0.54])
    target = middle + extent * np.array([-0.02, 0.0, -0.06])
    return rrb.EyeControls3D(
        kind=rrb.Eye3DKind.Orbital, position=frame.points(eye), look_target=frame.points(target)
    )


def _extent(history: History) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the corners of the box around every place of every agent, and the target."""
    places = history.agents.position.reshape(-1, 3)
    if history.target is not None:
        places = np.concatenate([places, history.target[None]])
    return places.min(axis=0), places.max(axis=0)


def _log() -> rrb.TextLogView:
    columns = [rrb.encodings.TextLogColumn(kind) for kind in ("LogLevel", "Body")]
    return rrb.TextLogView(
        origin="events", name="Events", columns=rrb.TextLogColumns(text_log_columns=columns)
    )


def _plots(layout: Layout) -> rrb.Container:
    """Return one plot a measure, in tabs."""
    seats = range(len(layout.names))
    views = [
        rrb.TimeSeriesView(
            name=TITLES[measure],
            contents=[f"+ /{path_of(seat)}/{measure}" for seat in seats],
            plot_legend=rrb.PlotLegend(visible=len(seats) > 1),
        )
        for measure in layout.plots
    ]
    return rrb.Tabs(*views, name="Numbers")
