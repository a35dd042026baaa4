"""Workspaces for tracing images, cached because allocating one takes longer than tracing a small image."""

import functools
import threading
from collections.abc import Callable, Hashable
from typing import Any, NamedTuple, TypeVar, cast

import numpy as np

from wildscav_engine.compilation.kernel import PLAIN, inlined_kernel
from wildscav_engine.compilation.tables.array_tables import Addresses, addresses_of, reader
from wildscav_engine.rendering.tracing.front_to_back import Scratch, allocate_scratch
from wildscav_engine.rendering.tracing.hit_buffer import MOST_AT_ONCE, ImageArrays, allocate_image
from wildscav_engine.rendering.tracing.scene_arrays import Blocks, SceneArrays, Shapes

Made = TypeVar("Made")

MAX_CACHED = 8  # workspaces per thread and scene
LARGEST_CACHED = 2**16  # rays of the largest image whose workspace is cached in its scene


class Size(NamedTuple):
    """The size of an image and of its moving solids, which a workspace depends on."""

    height: int  # pixels
    width: int  # pixels
    half_width: float  # see ``Cameras``
    most_faces: int = 0  # of any moving solid


class LatestOfThread(threading.local):
    """What each thread made for the latest few sizes: memory that was just used is faster than fresh one."""

    def __init__(self, most: int = MAX_CACHED) -> None:
        """Keep at most so many things for a thread."""
        self.cached: dict[Hashable, Any] = {}
        self._most = most

    def get(self, size: Hashable, make: Callable[[], Made]) -> Made:
        """Return what was made for a size, or make it, once there is room for it."""
        if size not in self.cached:
            if len(self.cached) >= self._most:
                self.cached.clear()
            self.cached[size] = make()
        made: Made = self.cached[size]
        return made


# The arrays for images of a size, and the scratch buffers for scenes up to the next powers of two of their
# sizes. All scenes share them, so that they stay in the processor's cache when a thread traces one scene
# after another, as vector environments do.
images, scratches = LatestOfThread(), LatestOfThread()
# The latest large image, whichever scene it showed: those that show one large image after another need no new
# one, and no more than one takes memory.
latest_large = LatestOfThread(1)


class Workspace(NamedTuple):
    """The arrays for tracing images of one size in one scene."""

    solids: Shapes
    blocks: Blocks
    image: ImageArrays
    scratch: Scratch


class WorkspaceTable:
    """A workspace, which it keeps alive, and the table of its addresses."""

    def __init__(self, workspace: Workspace) -> None:
        """Store the addresses of the arrays."""
        self.arrays = workspace
        # (1, F, 6) in the form that kernels take for several images
        self.tables = np.concatenate([addresses_of(part) for part in workspace])[np.newaxis]


def allocate_workspace(scene: SceneArrays, size: Size, image: ImageArrays) -> WorkspaceTable:
    """Return a workspace for images of a size."""
    most_faces = int(np.diff(scene.solids.face_start).max(initial=0))
    sizes = len(scene.blocks.lowest), len(scene.solids.obbs), max(most_faces, size.most_faces)
    rounded = tuple(1 << size.bit_length() for size in sizes)
    scratch = scratches.get(rounded, lambda: allocate_scratch(*rounded))
    return WorkspaceTable(Workspace(*scene, image, scratch))


_ROWS, _INTEGERS, _FLOATS = np.zeros((0, 1)), np.zeros(0, np.int64), np.zeros(0, np.float32)
_read_solids = reader(Shapes(_ROWS, _INTEGERS, _ROWS, _INTEGERS, _INTEGERS))
_read_blocks = reader(
    Blocks(
        *(_ROWS, _ROWS, np.zeros(0), np.zeros((0, 1), np.float32), np.zeros(2), _INTEGERS, _INTEGERS),
        *(np.zeros((0, 1), np.float32), _FLOATS, _FLOATS, np.zeros((0, 1), np.float32)),
        *(_INTEGERS, np.zeros(0, np.int8)),
    )
)
_read_image = reader(allocate_image(1, 1, 1.0))
_read_scratch = reader(allocate_scratch(1, 1, 1))
BLOCKS = len(Shapes._fields)  # the row of a table where the blocks begin
IMAGE = BLOCKS + len(Blocks._fields)
SCRATCH = IMAGE + len(ImageArrays._fields)


@inlined_kernel
def read_workspace(table: Addresses) -> Workspace:
    """Return the workspace of a table."""
    return Workspace(
        _read_solids(table[:BLOCKS]),
        _read_blocks(table[BLOCKS:IMAGE]),
        _read_image(table[IMAGE:SCRATCH]),
        _read_scratch(table[SCRATCH:]),
    )


def new_image(shape: tuple[int, int, float]) -> ImageArrays:
    """Return the arrays for images of a height, width and half width."""
    return allocate_image(*shape, rays_at_once())


@functools.cache
def rays_at_once() -> int:
    """Return how many rays the processor intersects at once: how many float64 the compiler puts in a vector.

    It uses vectors of 512 bits on processors of AMD that have them, and of 256 bits on all others.
    """
    if PLAIN:
        return MOST_AT_ONCE
    from llvmlite import binding
    from numba.core import config

    settings, host = cast(Any, config), cast(Any, binding)
    name = settings.CPU_NAME or host.get_host_cpu_name()
    return 8 if name.startswith("znver") and int(name.removeprefix("znver")) >= 4 else 4


class Workspaces(LatestOfThread):
    """The cached workspaces of one scene, separate for each thread."""

    def __reduce__(self) -> tuple[type["Workspaces"], tuple[()]]:
        """Copies and pickles are empty."""
        return Workspaces, ()

    def of(self, scene: SceneArrays, size: Size) -> WorkspaceTable:
        """Return the workspace for images of a size; ``scene`` is always the same one."""
        return self.cached.get(size) or self.make(scene, size)

    def make(self, scene: SceneArrays, size: Size) -> WorkspaceTable:
        """Allocate a workspace that is not cached yet."""
        shape = size[:3]
        if size.height * size.width > LARGEST_CACHED:
            # The workspace keeps its solids alive, so no others have their id.
            key = size, id(scene.solids)
            return latest_large.get(key, lambda: allocate_workspace(scene, size, new_image(shape)))
        image = images.get(shape, lambda: new_image(shape))
        return self.get(size, lambda: allocate_workspace(scene, size, image))
