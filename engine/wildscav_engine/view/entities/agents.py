"""The agents of a replay: bodies, names, trails and plotted quantities.

Bodies are meshes with the same parts and colours as in the images of cameras.
"""

from collections.abc import Iterator, Sequence
from functools import lru_cache
from typing import NamedTuple

import numpy as np
import rerun as rr
from numpy.typing import NDArray

from wildscav_engine.rendering.palette import of_seat
from wildscav_engine.sensors.optics.dynamic_objects import INVINCIBLE_WHITE
from wildscav_engine.sensors.optics.object_parts import BODY, BODY_PARTS, colors_of_bodies
from wildscav_engine.view.recording import colors, coordinates
from wildscav_engine.view.recording.columns import Columns
from wildscav_engine.view.recording.history import History, changes

# The corners of a part are numbered by the bits (along, up, across).
SIDES = np.array([[0, 2, 6, 4], [1, 5, 7, 3], [0, 4, 5, 1], [2, 3, 7, 6], [0, 1, 3, 2], [4, 6, 7, 5]])
GREY = 0.85  # weight of grey in the colours of a dead body
LYING = 0.2  # m by which a body on its back is raised
LABEL_HEIGHT = 2.6  # m above the soles
DOT = rr.Radius.ui_points(3.5)  # in the agent's colour above it, visible from afar
TRAIL = rr.Radius.ui_points(1.5)
TRAIL_STEP_LIMIT = 4.0  # m; a longer step is a respawn


class BodyMesh(NamedTuple):
    """A body at the origin that faces north, in Rerun's coordinates; every side has its own vertices."""

    positions: NDArray[np.float32]  # (V, 3) m
    normals: NDArray[np.float32]  # (V, 3)
    triangles: NDArray[np.int32]  # (T, 3)


class BodyColors(NamedTuple):
    """The colours of a team's bodies."""

    usual: NDArray[np.uint8]  # (V, 3)
    invincible: NDArray[np.uint8]  # (V, 3)
    dead: NDArray[np.uint8]  # (V, 3)


@lru_cache(maxsize=1)
def body_mesh() -> BodyMesh:
    """Return the body of an agent."""
    corners = BODY_PARTS.corners[:, SIDES]  # (P, 6, 4, 3)
    normals = np.cross(corners[:, :, 1] - corners[:, :, 0], corners[:, :, 3] - corners[:, :, 0])
    outwards = corners.mean(axis=2) - corners.mean(axis=(1, 2))[:, None]
    normals *= np.sign((normals * outwards).sum(axis=-1, keepdims=True))
    normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
    first = 4 * np.arange(len(BODY) * len(SIDES), dtype=np.int32)[:, None]
    triangles = np.concatenate([first + corner for corner in np.array([[0, 1, 2], [0, 2, 3]], np.int32)])
    normals = np.repeat(normals.reshape(-1, 3), 4, axis=0)
    return BodyMesh(coordinates.points(corners.reshape(-1, 3)), coordinates.points(normals), triangles)


@lru_cache(maxsize=1024)
def body_colors(team: int) -> BodyColors:
    """Return the colours of a team's bodies, vertex by vertex."""
    parts = colors_of_bodies(team + 1)[team]
    usual = np.repeat(parts, 4 * len(SIDES), axis=0)
    invincible = usual + (255.0 - usual) * INVINCIBLE_WHITE
    dead = usual + (np.array(colors.DEAD) - usual) * GREY
    return BodyColors(*(np.round(each).astype(np.uint8) for each in (usual, invincible, dead)))


def poses(
    yaw: NDArray[np.float64], dead: NDArray[np.bool_]
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Return (N, 4) quaternions x, y, z, w and (N, 3) m offsets of N bodies, standing or on their backs."""
    turn, tilt = np.radians(-yaw) / 2, np.where(dead, np.pi / 4, 0.0)
    about_z, upright = np.sin(turn), np.cos(turn)
    rotations = np.stack(
        [upright * np.sin(tilt), about_z * np.sin(tilt), about_z * np.cos(tilt), upright * np.cos(tilt)],
        axis=-1,
    )
    offsets = np.zeros((len(yaw), 3), np.float32)
    offsets[dead, 2] = LYING
    return rotations.astype(np.float32), offsets


def path_of(seat: int) -> str:
    """Return the entity path of an agent, whose origin is between its soles."""
    return f"agents/seat_{seat}"


def distinct(names: Sequence[str]) -> tuple[str, ...]:
    """Return the names of the seats, with the number of the seat if a name is not unique."""
    return tuple(name if names.count(name) == 1 else f"{name} ({seat})" for seat, name in enumerate(names))


def static_agents(history: History, names: Sequence[str]) -> Iterator[tuple[str, rr.AsComponents]]:
    """Yield the static components of the agents."""
    positions, normals, triangles = body_mesh()
    mesh = rr.Mesh3D.from_fields(
        vertex_positions=positions, vertex_normals=normals, triangle_indices=triangles
    )
    for seat, name in enumerate(names):
        path, team = path_of(seat), history.team_of(seat)
        yield f"{path}/body", mesh
        label = rr.Points3D.from_fields(positions=(0, 0, LABEL_HEIGHT), radii=DOT, show_labels=True)
        yield f"{path}/name", label
        yield f"trails/seat_{seat}", rr.LineStrips3D.from_fields(radii=TRAIL, colors=[of_seat(team)])
        tint = line_color(history, seat)
        for quantity in plotted(history):
            line = rr.SeriesLines(colors=[tint], names=[name], widths=[2.0], interpolation_mode="StepAfter")
            yield f"{path}/{quantity}", line


def line_color(history: History, seat: int) -> colors.Color:
    """Return the colour of an agent in plots: that of its team, or its own if there is only one team."""
    is_one_team = len(np.unique(history.teams)) == 1
    return colors.team_color(seat if is_one_team else history.team_of(seat))


def moving_agents(history: History, names: Sequence[str], *, health: bool) -> Iterator[Columns]:
    """Yield the components of the agents that change; labels show ``health`` if agents can be hurt."""
    for seat, name in enumerate(names):
        yield from _moving(history, seat)
        yield from _body(history, seat)
        yield _name(history, seat, name, health=health)
        for quantity, values in plotted(history).items():
            rows = np.union1d(changes(values[:, seat]), history.rows[-1:])
            scalars = rr.Scalars.columns(scalars=values[rows, seat].astype(np.float64))
            yield Columns(f"{path_of(seat)}/{quantity}", rows, scalars)


def plotted(history: History) -> dict[str, NDArray[np.generic]]:
    """Return the plotted quantities by name, each (T + 1, A)."""
    agents = history.agents
    quantities: dict[str, NDArray[np.generic]] = {
        "health": agents.health,
        "ammo": agents.clip + agents.spare_ammo,
        "supplies": agents.supplies,
    }
    if history.has_teammates:
        quantities["team_supplies"] = history.supplies_of_team
    if history.target is not None:
        quantities["distance"] = np.round(history.distance_to_target, 2)
    return quantities


def _moving(history: History, seat: int) -> Iterator[Columns]:
    """Yield the position of an agent and the segments of its trail."""
    position = history.agents.position[:, seat]
    rows = changes(position)
    yield Columns(path_of(seat), rows, rr.Transform3D.columns(translation=coordinates.points(position[rows])))

    segments = np.stack([position[:-1], position[1:]], axis=1)
    length = np.linalg.norm(segments[:, 1] - segments[:, 0], axis=-1)
    rows = np.nonzero((length > 0) & (length < TRAIL_STEP_LIMIT))[0] + 1
    strips = coordinates.points(segments[rows - 1] + np.array([0.0, 0.15, 0.0]))
    yield Columns(f"trails/seat_{seat}", rows, rr.LineStrips3D.columns(strips=strips))


def _body(history: History, seat: int) -> Iterator[Columns]:
    """Yield the pose and the colours of a body: pale while invincible, grey and lying when dead."""
    agents, path = history.agents, f"{path_of(seat)}/body"
    dead = agents.health[:, seat] <= 0
    rows = changes(agents.yaw[:, seat], dead)
    rotations, offsets = poses(agents.yaw[rows, seat], dead[rows])
    yield Columns(path, rows, rr.Transform3D.columns(quaternion=rotations, translation=offsets))

    invincible = agents.invincible_left[:, seat] > 0
    rows = changes(dead, invincible)
    own = body_colors(history.team_of(seat))
    tints = [own.dead if dead[row] else own.invincible if invincible[row] else own.usual for row in rows]
    columns = rr.Mesh3D.columns(vertex_colors=np.concatenate(tints))
    yield Columns(path, rows, columns.partition([len(own.usual)] * len(rows)))


def _name(history: History, seat: int, name: str, *, health: bool) -> Columns:
    """Return the label above an agent: its name and its health."""
    left = history.agents.health[:, seat]
    rows = changes(left)
    shown = [f"{name} · {hp}" if health else name for hp in left[rows].tolist()]
    labels = [label if hp > 0 else f"{name} · dead" for label, hp in zip(shown, left[rows], strict=True)]
    alive, dead = colors.team_color(history.team_of(seat)), colors.readable(colors.DEAD)
    tints = np.where(left[rows, None] > 0, np.array(alive), np.array(dead)).astype(np.uint8)
    return Columns(f"{path_of(seat)}/name", rows, rr.Points3D.columns(labels=labels, colors=tints))
