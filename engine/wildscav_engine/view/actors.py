"""The agents of a replay: bodies, names, view directions, trails and their numbers over time."""

from collections.abc import Iterator, Sequence

import numpy as np
import rerun as rr
from numpy.typing import NDArray

from wildscav_engine.body import BODY_HEIGHT, BODY_RADIUS, EYE_HEIGHT
from wildscav_engine.palette import of_seat
from wildscav_engine.view import colors, frame
from wildscav_engine.view.columns import Columns
from wildscav_engine.view.history import History, changes

LABEL_HEIGHT = 2.6  # m above the soles, where the name is
DOT = rr.Radius.ui_points(3.0)  # in the agent's colour above it, to be seen from afar
ARROW = 1.6  # m, length of the view direction
TRAIL_STEP_LIMIT = 4.0  # m; more than that in one step is a respawn, not a way


def path_of(seat: int) -> str:
    """Return the entity of an agent; its place is the middle of its soles."""
    return f"agents/seat_{seat}"


def distinct(names: Sequence[str]) -> tuple[str, ...]:
    """Return the names of the seats, with the seat's number where two are alike."""
    return tuple(name if names.count(name) == 1 else f"{name} ({seat})" for seat, name in enumerate(names))


def static_agents(history: History, names: Sequence[str]) -> Iterator[tuple[str, rr.AsComponents]]:
    """Yield what never changes about the agents."""
    for seat, name in enumerate(names):
        path, color = path_of(seat), of_seat(seat)
        yield f"{path}/body", rr.Capsules3D.from_fields(radii=BODY_RADIUS, fill_mode="solid")
        yield (
            f"{path}/name",
            rr.Points3D.from_fields(positions=(0, 0, LABEL_HEIGHT), radii=DOT, show_labels=True),
        )
        yield (
            f"{path}/view",
            rr.Arrows3D.from_fields(origins=(0, 0, EYE_HEIGHT), radii=0.06, colors=[color]),
        )
        yield f"trails/seat_{seat}", rr.LineStrips3D.from_fields(radii=0.04, colors=[(*color, 150)])
        for measure in measures(history):
            yield (
                f"{path}/{measure}",
                rr.SeriesLines(colors=[color], names=[name], interpolation_mode="StepAfter"),
            )


def moving_agents(history: History, names: Sequence[str]) -> Iterator[Columns]:
    """Yield all that changes about the agents."""
    for seat, name in enumerate(names):
        yield from _moving(history, seat)
        yield from _body(history, seat, name)
        for measure, values in measures(history).items():
            rows = np.union1d(changes(values[:, seat]), history.rows[-1:])
            scalars = rr.Scalars.columns(scalars=values[rows, seat].astype(np.float64))
            yield Columns(f"{path_of(seat)}/{measure}", rows, scalars)


def measures(history: History) -> dict[str, NDArray[np.generic]]:
    """Return the (T + 1, A) numbers that are plotted."""
    agents = history.agents
    found: dict[str, NDArray[np.generic]] = {
        "health": agents.health,
        "ammo": agents.clip + agents.spare_ammo,
        "supplies": agents.supplies,
    }
    if history.target is not None:
        found["distance"] = np.round(np.linalg.norm(agents.position - history.target, axis=-1), 2)
    return found


def _moving(history: History, seat: int) -> Iterator[Columns]:
    agents, path = history.agents, path_of(seat)
    position = agents.position[:, seat]
    rows = changes(position)
    yield Columns(path, rows, rr.Transform3D.columns(translation=frame.points(position[rows])))

    alive = agents.health[:, seat] > 0
    gaze = frame.directions(agents.yaw[:, seat], agents.pitch[:, seat]) * (ARROW * alive)[:, None]
    rows = changes(gaze)
    yield Columns(f"{path}/view", rows, rr.Arrows3D.columns(vectors=frame.points(gaze[rows])))

    ways = np.stack([position[:-1], position[1:]], axis=1)
    length = np.linalg.norm(ways[:, 1] - ways[:, 0], axis=-1)
    rows = np.nonzero((length > 0) & (length < TRAIL_STEP_LIMIT))[0] + 1
    strips = frame.points(ways[rows - 1] + np.array([0.0, 0.15, 0.0]))
    yield Columns(f"trails/seat_{seat}", rows, rr.LineStrips3D.columns(strips=strips))


def _body(history: History, seat: int, name: str) -> Iterator[Columns]:
    """Yield the capsule, pale while it cannot be hurt, a grey ball on the ground while dead, and its name."""
    agents, path = history.agents, path_of(seat)
    rows = changes(agents.health[:, seat], agents.invincible_left[:, seat] > 0)
    health, safe = agents.health[rows, seat], agents.invincible_left[rows, seat] > 0
    dead = health <= 0
    color = np.array(of_seat(seat))
    tint = np.where(safe[:, None], (color + 255) // 2, color)
    tint = np.where(dead[:, None], np.array(colors.DEAD), tint).astype(np.uint8)
    capsules = rr.Capsules3D.columns(
        lengths=np.where(dead, 0.0, BODY_HEIGHT - 2 * BODY_RADIUS),
        translations=np.tile([0.0, 0.0, BODY_RADIUS], (len(rows), 1)),
        colors=tint,
    )
    yield Columns(f"{path}/body", rows, capsules)
    labels = [
        f"{name} · dead" if gone else f"{name} · {left}" for gone, left in zip(dead, health, strict=True)
    ]
    yield Columns(f"{path}/name", rows, rr.Points3D.columns(labels=labels, colors=tint))
