"""The blueprint of a replay: the layout of the viewer when the file is opened."""

from typing import Any, NamedTuple

import rerun as rr
import rerun.blueprint as rrb

from wildscav_engine.view.entities.agents import path_of
from wildscav_engine.view.entities.follow_cameras import ABOVE, COLOR, DEPTH, EYES, SCALE_HEIGHT
from wildscav_engine.view.events import EVENTS, KILLS
from wildscav_engine.view.notes import PLOTS
from wildscav_engine.view.overview import Overview
from wildscav_engine.view.recording import coordinates
from wildscav_engine.view.recording.columns import MATCH_TIME, STEP
from wildscav_engine.view.recording.history import DEPTH_CAMERA
from wildscav_engine.view.standings import PATH as STANDINGS

TRAIL_TIME, TRAIL_STEPS = 6.0, 60  # s on the timeline of match time; on that of steps
SKY = (150, 190, 225)
MARGIN = 2.0  # pixels around a depth map
ALL = rrb.TimeRangeBoundary.infinite()  # plots show the whole match
TITLES = {
    "distance": "Distance to the target",
    "team_supplies": "Score: supplies of the team",
    "supplies": "Supplies",
    "health": "Health",
    "ammo": "Ammunition",
}
# In the follow view, these are transparent, so that the agent stays visible; roofs are hidden.
TRANSPARENT_TINT = (255, 255, 255, 70)
ROOFS = "world/houses/roofs"
TRANSPARENT_PATHS = (
    *("world/houses/walls", "world/houses/floors", "world/houses/stairs"),
    *("world/vegetation/crowns", "world/vegetation/trunks", "world/rocks"),
)
GROUND_OVERLAYS = ("heat", "zone/outside")  # hidden in the views near an agent, where they seem to float


class Layout(NamedTuple):
    """What the blueprint of a replay depends on."""

    names: tuple[str, ...]
    follow: int
    plots: tuple[str, ...]  # the plotted quantities, the score first
    images: bool  # whether the file contains depth maps and camera images
    kills: bool  # whether agents can kill each other
    transparent: tuple[str, ...]  # those of ``TRANSPARENT_PATHS`` that the map has
    own_plots: bool = False  # whether agents plot quantities of their own


def blueprint(layout: Layout, overview: Overview) -> rrb.Blueprint:
    """Return the blueprint: standings, the whole match, one agent from above and from its eyes, and plots."""
    name, followed = layout.names[layout.follow], path_of(layout.follow)
    transparent = {
        path: rr.Mesh3D.from_fields(albedo_factor=TRANSPARENT_TINT).visualizer()
        for path in layout.transparent
    }
    free = _spatial("Match", ["+ /**", *_hidden("follow")], _eye(overview), trails=len(layout.names))
    follow_views = (
        _spatial(
            f"Following {name}",
            ["+ /**", *_hidden("follow", "trails", *GROUND_OVERLAYS, ROOFS), f"+ /{ABOVE}"],
            rrb.EyeControls3D(tracking_entity=f"/{ABOVE}"),
            overrides=transparent,
        ),
        _spatial(
            f"Eyes of {name}",
            ["+ /**", *_hidden("follow", "trails", *GROUND_OVERLAYS, followed), f"+ /{EYES}"],
            rrb.EyeControls3D(tracking_entity=f"/{EYES}"),
        ),
    )
    above = rrb.Horizontal(
        rrb.Vertical(
            rrb.TextDocumentView(origin=STANDINGS, name="Standings"), _logs(layout), row_shares=[3, 2]
        ),
        free,
        rrb.Vertical(*follow_views),
        column_shares=[3, 6, 4],
    )
    below: list[rrb.View | rrb.Container] = [_plots(layout)]
    if layout.images:
        below.append(rrb.Spatial2DView(origin=COLOR, name=f"Camera of {name}"))
        # The area of a depth map and its scale, so that no number of the scale is cut off.
        across, down = (-MARGIN, DEPTH_CAMERA.width + MARGIN), (-MARGIN, DEPTH_CAMERA.height + SCALE_HEIGHT)
        bounds = rrb.VisualBounds2D(x_range=across, y_range=down)
        below.append(rrb.Spatial2DView(origin=DEPTH, name=f"Depth map of {name}", visual_bounds=bounds))
    return rrb.Blueprint(
        rrb.Vertical(above, rrb.Horizontal(*below, column_shares=[7, 3, 3][: len(below)]), row_shares=[5, 2]),
        rrb.BlueprintPanel(state="collapsed"),
        rrb.SelectionPanel(state="collapsed"),
        rrb.TimePanel(state="collapsed", timeline=MATCH_TIME, play_state="playing"),
    )


def _hidden(*paths: str) -> list[str]:
    """Return the query lines that hide some entities, and all that do not belong to the 3D scene."""
    return [f"- /{path}/**" for path in (*paths, EVENTS, KILLS, STANDINGS, PLOTS)]


def _spatial(
    name: str,
    contents: list[str],
    eye: rrb.EyeControls3D,
    trails: int = 0,
    overrides: dict[str, rrb.Visualizer] | None = None,
) -> rrb.Spatial3DView:
    shown: dict[Any, Any] = {f"trails/seat_{seat}": _trail() for seat in range(trails)} | (overrides or {})
    return rrb.Spatial3DView(
        origin="/",
        name=name,
        contents=contents,
        eye_controls=eye,
        background=SKY,
        line_grid=False,
        overrides=shown,
    )


def _trail() -> rrb.VisibleTimeRanges:
    """Return how much of a trail is visible: the last few seconds, on either timeline."""
    seconds = rrb.TimeRangeBoundary.cursor_relative(seconds=-TRAIL_TIME)
    steps = rrb.TimeRangeBoundary.cursor_relative(seq=-TRAIL_STEPS)
    now = rrb.TimeRangeBoundary.cursor_relative(seq=0)
    return rrb.VisibleTimeRanges(
        [
            rrb.VisibleTimeRange(MATCH_TIME, start=seconds, end=now),
            rrb.VisibleTimeRange(STEP, start=steps, end=now),
        ]
    )


def _eye(overview: Overview) -> rrb.EyeControls3D:
    return rrb.EyeControls3D(
        kind=rrb.Eye3DKind.Orbital,
        position=coordinates.points(overview.eye),
        look_target=coordinates.points(overview.target),
    )


def _logs(layout: Layout) -> rrb.View | rrb.Container:
    """Return the log of all events, behind the log of kills if the track has any.

    The level of an event has no column, because its text and colour already show what it is.
    """
    columns = rrb.TextLogColumns(text_log_columns=[rrb.encodings.TextLogColumn("Body")])
    views = [
        rrb.TextLogView(origin=path, name=name, columns=columns)
        for path, name in ((KILLS, "Kills"), (EVENTS, "All events"))
    ]
    return rrb.Tabs(*views) if layout.kills else views[1]


def _plots(layout: Layout) -> rrb.Container:
    """Return one plot per quantity, in tabs; the first is the score."""
    seats = range(len(layout.names))
    contents = {
        TITLES[quantity]: [f"+ /{path_of(seat)}/{quantity}" for seat in seats] for quantity in layout.plots
    }
    if layout.own_plots:
        contents["What agents plot"] = [f"+ /{PLOTS}/**"]
    views = [
        rrb.TimeSeriesView(
            name=name,
            contents=some,
            axis_x=rrb.TimeAxis(view_range=rrb.TimeRange(start=ALL, end=ALL)),
            plot_legend=rrb.PlotLegend(corner=rrb.Corner2D.LeftTop, visible=len(seats) > 1),
        )
        for name, some in contents.items()
    ]
    return rrb.Tabs(*views, name="Numbers")
