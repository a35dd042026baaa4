"""The objects of a replay: supply boxes, shots, hits, the start and the target."""

from collections.abc import Iterator

import numpy as np
import rerun as rr
from numpy.typing import NDArray

from wildscav_engine.maps.game_map import GameMap
from wildscav_engine.simulation.state import NOBODY
from wildscav_engine.specs.body import EYE_HEIGHT
from wildscav_engine.view.recording import colors, coordinates
from wildscav_engine.view.recording.columns import Columns
from wildscav_engine.view.recording.history import Boxes, History, changes

SMALLEST_BOX, LARGEST_BOX = 0.4, 1.0  # m, sides of boxes with 0 and with FULL_BOX supplies
FULL_BOX = 50
# From the eye itself, a shot would look like a dot.
MUZZLE = (0.25, -0.3)  # m right of the eye and above it
UP = np.array([0.0, 1.0, 0.0])
PILLAR = 25.0  # m, height of the pillar of light at the target


def static_objects(history: History, target_distance: float) -> Iterator[tuple[str, rr.AsComponents]]:
    """Yield the start and the target of a match that has one, and the static components of the rest."""
    yield "supplies", rr.Boxes3D.from_fields(fill_mode="solid")
    yield "shots", rr.LineStrips3D.from_fields(radii=0.02)
    yield "hits", rr.Points3D.from_fields(radii=0.25, colors=[colors.HIT])
    if history.target is None:
        return
    start, target = history.agents.position[0, 0], history.target
    pillar = coordinates.points(target + PILLAR / 2 * UP)
    light = rr.Cylinders3D(
        lengths=[PILLAR],
        radii=[target_distance],
        centers=[pillar],
        colors=[(*colors.TARGET, 90)],
        fill_mode="solid",
    )
    yield "target/light", light
    yield "target/place", _marker(target, "target", colors.TARGET)
    yield "start", _marker(start, "start", colors.START)


def _marker(position: NDArray[np.float64], label: str, color: tuple[int, int, int]) -> rr.Points3D:
    center = coordinates.points(position + 0.3 * UP)
    return rr.Points3D([center], radii=0.3, colors=[color], labels=[label], show_labels=True)


def changing_objects(history: History, game_map: GameMap) -> Iterator[Columns]:
    """Yield supply boxes, shots and hits."""
    yield _boxes(history, game_map)
    yield from _shots(history)


def _boxes(history: History, game_map: GameMap) -> Columns:
    box_sets = history.boxes
    lengths = [len(boxes.serial) for boxes in box_sets]
    quantity = np.concatenate([boxes.quantity for boxes in box_sets])
    half = _sides(quantity) / 2
    position = np.concatenate([boxes.position for boxes in box_sets]).reshape(-1, 3)
    tint = np.concatenate([_box_colors(boxes, history.first_dropped, game_map) for boxes in box_sets])
    columns = rr.Boxes3D.columns(
        centers=coordinates.points(position + half[:, None] * UP),
        half_sizes=np.repeat(half[:, None], 3, axis=1),
        colors=tint.reshape(-1, 3),
    )
    return Columns("supplies", np.array([boxes.row for boxes in box_sets]), columns.partition(lengths))


def _sides(quantity: NDArray[np.int32]) -> NDArray[np.float64]:
    return SMALLEST_BOX + (LARGEST_BOX - SMALLEST_BOX) * np.sqrt(np.minimum(1.0, quantity / FULL_BOX))


def _box_colors(boxes: Boxes, first_dropped: int, game_map: GameMap) -> NDArray[np.uint8]:
    tint = np.tile(np.array(colors.OUTDOOR_BOX, np.uint8), (len(boxes.serial), 1))
    for house in game_map.houses:
        tint[house.covers(boxes.position)] = colors.INDOOR_BOX
    tint[boxes.serial >= first_dropped] = colors.DROPPED_BOX
    return tint


def _shots(history: History) -> Iterator[Columns]:
    """Yield lines from eye to end and points at hits, which disappear in the next step."""
    agents = history.agents
    hits = agents.fired & (agents.hit_seat != NOBODY)
    right = coordinates.directions(agents.yaw + 90.0, np.zeros_like(agents.yaw))
    muzzle = agents.position + (EYE_HEIGHT + MUZZLE[1]) * UP + MUZZLE[0] * right
    segments = coordinates.points(np.stack([muzzle, agents.shot_end], axis=-2))  # (T + 1, A, 2, 3)
    tint = np.where(hits[..., None], np.array(colors.HIT), np.array(colors.SHOT)).astype(np.uint8)

    rows = _rows_with_clearing(agents.fired)
    shown = agents.fired[rows]
    strips = rr.LineStrips3D.columns(strips=segments[rows][shown], colors=tint[rows][shown])
    yield Columns("shots", rows, strips.partition(shown.sum(axis=1)))

    rows = _rows_with_clearing(hits)
    shown = hits[rows]
    points = rr.Points3D.columns(positions=coordinates.points(agents.shot_end[rows][shown]))
    yield Columns("hits", rows, points.partition(shown.sum(axis=1)))


def _rows_with_clearing(present: NDArray[np.bool_]) -> NDArray[np.int64]:
    """Return the rows with any true entry, and the rows right after, in which the entity is cleared."""
    some = np.asarray(present.any(axis=1))
    if not some.any():
        return np.zeros(0, np.int64)
    return np.union1d(np.nonzero(some)[0], changes(some))
