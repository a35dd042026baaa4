"""Room to make images in, kept for the next ones: to make it takes longer than a small image."""

import threading
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.handles import Handle, reader
from wildscav_engine.rendering.tracing.canvas import allocate_rays, allocate_strips
from wildscav_engine.rendering.tracing.look import allocate_desk
from wildscav_engine.rendering.tracing.packing import Packed

KEPT = 8  # rooms of a thread and a scene
MOST_KEPT = 2**16  # rays of an image whose room is kept


class Room(NamedTuple):
    """Room for the images of one size, of one scene."""

    numbers: NDArray[np.float64]  # the scene; see ``Packed``
    indices: NDArray[np.int64]
    halves: NDArray[np.float32]
    rays: NDArray[np.float64]  # the image; see ``canvas_on``
    met: NDArray[np.int32]
    strips: NDArray[np.float64]
    sketch: NDArray[np.float32]  # from here on, see ``Desk``
    boxes: NDArray[np.float32]
    outside: NDArray[np.float64]
    shown: NDArray[np.float32]
    queue: NDArray[np.int64]
    rings: NDArray[np.int64]
    cells: NDArray[np.int64]
    done: NDArray[np.int64]


def allocate_room(scene: Packed, height: int, width: int, half_width: float, most_faces: int) -> Room:
    """Return room for images of a size, whose half width has this tangent, with solids of so many faces."""
    return Room(
        scene.numbers,
        scene.indices,
        scene.halves,
        allocate_rays(height, width, half_width),
        np.empty(height * width, np.int32),
        allocate_strips(height, width),
        *allocate_desk(scene.blocks, scene.solids, max(scene.most_faces, most_faces)),
    )


NOWHERE = Packed(np.zeros(0), np.zeros(0, np.int64), np.zeros(0, np.float32), 0, 0, 0)
read_room = reader(allocate_room(NOWHERE, 1, 1, 1.0, 0))


class Rooms(threading.local):
    """The rooms of one scene, each thread's own."""

    def __init__(self) -> None:
        self._kept: dict[tuple[tuple[int, ...], float, int], Handle] = {}

    def __reduce__(self) -> tuple[type["Rooms"], tuple[()]]:
        """Copy and pickle as what is empty."""
        return Rooms, ()

    def of(self, scene: Packed, others: Packed, shape: tuple[int, ...], half_width: float) -> Handle:
        """Return room for images.

        Args:
            scene: Always the same.
            others: What moves in it.
            shape: Height and width of the images.
            half_width: See ``Cameras``.
        """
        key = (shape, half_width, others.most_faces)
        return self._kept.get(key) or self._new(scene, key)

    def _new(self, scene: Packed, key: tuple[tuple[int, ...], float, int]) -> Handle:
        (height, width), half_width, most_faces = key
        room = Handle(allocate_room(scene, height, width, half_width, most_faces))
        if height * width <= MOST_KEPT:
            if len(self._kept) >= KEPT:
                self._kept.clear()
            self._kept[key] = room
        return room
