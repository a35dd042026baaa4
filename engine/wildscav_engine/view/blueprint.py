"""How a replay is laid out when it is opened: the blueprint in the file."""

from typing import Any, NamedTuple

import rerun as rr
import rerun.blueprint as rrb

from wildscav_engine.view.entities.agents import path_of
from wildscav_engine.view.entities.depth import DEPTH, SCALE_HEIGHT
from wildscav_engine.view.entities.follow import ABOVE, COLOR, EYES
from wildscav_engine.view.events import EVENTS, KILLS
from wildscav_engine.view.overview import Overview
from wildscav_engine.view.recording import frame
from wildscav_engine.view.recording.columns import MATCH_TIME, STEP
from wildscav_engine.view.recording.history import DEPTH_CAMERA
from wildscav_engine.view.standings import PATH as STANDINGS

TRAIL_TIME, TRAIL_STEPS = 6.0, 60  # s; on the time line of steps
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
# What stands between the camera and whom it follows is glass there; roofs are left out altogether.
GLASS = (255, 255, 255, 70)
ROOFS = "world/houses/roofs"
LIKE_GLASS = (
    *("world/houses/walls", "world/houses/floors", "world/houses/stairs"),
    *("world/vegetation/crowns", "world/vegetation/trunks", "world/rocks"),
)


ON_THE_GROUND = ("heat", "zone/outside")  # colours that would float before an agent's eyes


class Layout(NamedTuple):
    """What the blueprint depends on."""

    names: tuple[str, ...]
    follow: int
    plots: tuple[str, ...]  # measures, the score first
    images: bool  # whether depth maps and pictures are in the file
    kills: bool  # whether agents can kill each other
    glass: tuple[str, ...]  # those of ``LIKE_GLASS`` that are there


def blueprint(layout: Layout, overview: Overview) -> rrb.Blueprint:
    """Return the layout: standings, the whole match, one agent from above and through its eyes, and plots."""
    name, followed = layout.names[layout.follow], path_of(layout.follow)
    glass = {path: rr.Mesh3D.from_fields(albedo_factor=GLASS).visualizer() for path in layout.glass}
    free = _spatial("Match", ["+ /**", *_hidden("follow")], _eye(overview), trails=len(layout.names))
    follow_views = (
        _spatial(
            f"Following {name}",
            ["+ /**", *_hidden("follow", "trails", *ON_THE_GROUND, ROOFS), f"+ /{ABOVE}"],
            rrb.EyeControls3D(tracking_entity=f"/{ABOVE}"),
            overrides=glass,
        ),
        _spatial(
            f"Eyes of {name}",
            ["+ /**", *_hidden("follow", "trails", *ON_THE_GROUND, followed), f"+ /{EYES}"],
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
        below.append(
            rrb.Spatial2DView(origin=DEPTH, name=f"Depth map of {name}", visual_bounds=_depth_bounds())
        )
    return rrb.Blueprint(
        rrb.Vertical(above, rrb.Horizontal(*below, column_shares=[7, 3, 3][: len(below)]), row_shares=[5, 2]),
        rrb.BlueprintPanel(state="collapsed"),
        rrb.SelectionPanel(state="collapsed"),
        rrb.TimePanel(state="collapsed", timeline=MATCH_TIME, play_state="playing"),
    )


def _depth_bounds() -> rrb.VisualBounds2D:
    """Return what a depth map fills with its scale, so that no number of that is cut."""
    return rrb.VisualBounds2D(
        x_range=(-MARGIN, DEPTH_CAMERA.width + MARGIN),
        y_range=(-MARGIN, DEPTH_CAMERA.height + SCALE_HEIGHT),
    )


def _hidden(*paths: str) -> list[str]:
    """Return what is not seen in a 3D view: some entities, and those that are no part of the scene."""
    return [f"- /{path}/**" for path in (*paths, EVENTS, KILLS, STANDINGS)]


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


def _eye(overview: Overview) -> rrb.EyeControls3D:
    return rrb.EyeControls3D(
        kind=rrb.Eye3DKind.Orbital,
        position=frame.points(overview.eye),
        look_target=frame.points(overview.target),
    )


def _logs(layout: Layout) -> rrb.View | rrb.Container:
    """Return the log of all events, behind the feed of kills where there can be any.

    The kinds of events are in the file but in no column: the words tell them, and so does the colour.
    """
    columns = rrb.TextLogColumns(text_log_columns=[rrb.encodings.TextLogColumn("Body")])
    views = [
        rrb.TextLogView(origin=path, name=name, columns=columns)
        for path, name in ((KILLS, "Kills"), (EVENTS, "All events"))
    ]
    return rrb.Tabs(*views) if layout.kills else views[1]


def _plots(layout: Layout) -> rrb.Container:
    """Return one plot a measure, in tabs; the first is the score."""
    seats = range(len(layout.names))
    views = [
        rrb.TimeSeriesView(
            name=TITLES[measure],
            contents=[f"+ /{path_of(seat)}/{measure}" for seat in seats],
            axis_x=rrb.TimeAxis(view_range=rrb.TimeRange(start=ALL, end=ALL)),
            plot_legend=rrb.PlotLegend(corner=rrb.Corner2D.LeftTop, visible=len(seats) > 1),
        )
        for measure in layout.plots
    ]
    return rrb.Tabs(*views, name="Numbers")
