"""Workspaces for tracing images, cached because allocating one takes longer than tracing a small image."""

import threading
from typing import NamedTuple

import numpy as np

from wildscav_engine.compilation.array_tables import Addresses, addresses_of, reader
from wildscav_engine.compilation.kernel import inlined_kernel
from wildscav_engine.rendering.tracing.front_to_back import Scratch, allocate_scratch
from wildscav_engine.rendering.tracing.hit_buffer import ImageArrays, allocate_image
from wildscav_engine.rendering.tracing.scene_arrays import Blocks, SceneArrays, Shapes

MAX_CACHED = 8  # workspaces per thread and scene
LARGEST_CACHED = 2**16  # rays of the largest image whose workspace is cached in its scene


class Size(NamedTuple):
    """The size of an image and of its moving solids, which a workspace depends on."""

    height: int  # pixels
    width: int  # pixels
    half_width: float  # see ``Cameras``
    most_faces: int = 0  # of any moving solid


class Scratches(threading.local):
    """The scratch buffers of each thread, for scenes up to the next powers of two of their sizes.

    Scenes of about the same size share them for the same reason as the arrays for images.
    """

    def __init__(self) -> None:
        self._cached: dict[tuple[int, ...], Scratch] = {}

    def of(self, *sizes: int) -> Scratch:
        """Return buffers for a scene of at least these sizes, see ``allocate_scratch``."""
        rounded = tuple(1 << size.bit_length() for size in sizes)
        if rounded not in self._cached:
            if len(self._cached) >= MAX_CACHED:
                self._cached.clear()
            self._cached[rounded] = allocate_scratch(*rounded)
        return self._cached[rounded]


scratches = Scratches()


class Workspace(NamedTuple):
    """The arrays for tracing images of one size in one scene."""

    solids: Shapes
    blocks: Blocks
    image: ImageArrays
    scratch: Scratch


def allocate_workspace(scene: SceneArrays, size: Size, image: ImageArrays) -> Workspace:
    """Return a workspace for images of a size."""
    most_faces = int(np.diff(scene.solids.face_start).max(initial=0))
    sizes = len(scene.blocks.spans), len(scene.solids.boxes), max(most_faces, size.most_faces)
    return Workspace(*scene, image, scratches.of(*sizes))


class WorkspaceTable:
    """A workspace, which it keeps alive, and the table of its addresses."""

    def __init__(self, workspace: Workspace) -> None:
        """Store the addresses of the arrays."""
        self.arrays = workspace
        # (1, F, 6) in the form that kernels take for several images
        self.tables = np.concatenate([addresses_of(part) for part in workspace])[np.newaxis]


_ROWS, _INTEGERS, _FLOATS = np.zeros((0, 1)), np.zeros(0, np.int64), np.zeros(0, np.float32)
_read_solids = reader(Shapes(_ROWS, _INTEGERS, _ROWS, _INTEGERS, _INTEGERS))
_read_blocks = reader(
    Blocks(
        *(_ROWS, _ROWS, _ROWS, np.zeros(2), _INTEGERS, _INTEGERS, np.zeros((0, 1), np.float32)),
        *(_FLOATS, _FLOATS, np.zeros((0, 1), np.float32), _INTEGERS, np.zeros(0, np.int8)),
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


class Images(threading.local):
    """The arrays for images of the latest sizes, separate for each thread.

    All scenes share them, so that they stay in the processor's cache when a thread traces one scene after
    another, as vector environments do.
    """

    def __init__(self) -> None:
        self._cached: dict[Size, ImageArrays] = {}

    def of(self, size: Size) -> ImageArrays:
        """Return the arrays for images of a size."""
        size = size._replace(most_faces=0)
        if size not in self._cached:
            if len(self._cached) >= MAX_CACHED:
                self._cached.clear()
            self._cached[size] = allocate_image(*size[:3])
        return self._cached[size]


images = Images()


class Workspaces(threading.local):
    """The cached workspaces of one scene, separate for each thread."""

    def __init__(self) -> None:
        self.cached: dict[Size, WorkspaceTable] = {}

    def __reduce__(self) -> tuple[type["Workspaces"], tuple[()]]:
        """Copies and pickles are empty."""
        return Workspaces, ()

    def of(self, scene: SceneArrays, size: Size) -> WorkspaceTable:
        """Return the workspace for images of a size; ``scene`` is always the same one."""
        return self.cached.get(size) or self.make(scene, size)

    def make(self, scene: SceneArrays, size: Size) -> WorkspaceTable:
        """Allocate a workspace that is not cached yet."""
        if size.height * size.width > LARGEST_CACHED:
            return latest_large.of(scene, size)
        workspace = WorkspaceTable(allocate_workspace(scene, size, images.of(size)))
        if len(self.cached) >= MAX_CACHED:
            self.cached.clear()
        self.cached[size] = workspace
        return workspace


class LatestLarge(threading.local):
    """The workspace of the latest large image of each thread, whichever scene it showed.

    Those that show one large image after another need no new one, and no more than one takes memory.
    """

    def __init__(self) -> None:
        self._size: Size | None = None
        self._workspace: WorkspaceTable | None = None

    def of(self, scene: SceneArrays, size: Size) -> WorkspaceTable:
        """Return the workspace for images of a size in a scene."""
        workspace = self._workspace
        if workspace is None or self._size != size or workspace.arrays.solids is not scene.solids:
            self._workspace = None  # so that its memory is free before more is taken
            workspace = WorkspaceTable(allocate_workspace(scene, size, allocate_image(*size[:3])))
            self._size, self._workspace = size, workspace
        return workspace


latest_large = LatestLarge()
