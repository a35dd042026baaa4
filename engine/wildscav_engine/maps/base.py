"""Bases: imported ground and solids that maps are generated on.

A base is stored in a file named after the digest of its content, by which a ``MapConfig`` refers to it. The
file has the layout of ``storage.binary_format``, with this compressed payload, all float64: the heights, (R +
1, C + 1), unless the ground is flat; the planes of all solids, (F, 4); their least and greatest corners, (S,
3) each. Base files are untrusted, so everything in them is checked before anything is used.
"""

import os
import zlib
from collections.abc import Sequence
from hashlib import blake2b
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.geometry.world import CELL, Kind, Solid
from wildscav_engine.maps.errors import MapError
from wildscav_engine.maps.ground.lakes import DEEPEST_WATER
from wildscav_engine.storage.binary_format import (
    BinaryFormatError,
    Layout,
    canonical_json,
    decompress,
    pack,
    unpack,
)
from wildscav_engine.storage.files import read_limited, write_whole

SUFFIX = ".wsb"
LAYOUT = Layout(b"WILDBASE", 1, "an imported map")
HEADER_KEYS = {"name", "size", "water_level", "ground", "kinds", "faces"}
KINDS = tuple(kind for kind in Kind if Kind.WALL <= kind <= Kind.BUSH)  # allowed kinds of solids

SMALLEST, LARGEST = 40, 2000  # m, of each side
LOWEST, HIGHEST = -1000.0, 1000.0  # m, range of all heights
OVERHANG = 20.0  # m that a solid may reach beyond the border
MAX_SOLIDS = 20_000
MAX_FACES = 100  # of a solid; the time to draw one grows with the fourth power of this
# Of the grid that solids may touch, counted for each solid: the cost of indexing them
MAX_CELLS = 20_000_000
FILE_LIMIT = 80 << 20  # bytes: more than the most solids with the most faces need
NAME_LIMIT = 80  # characters
UNIT = 1e-6  # how far the length of a normal may be from 1
NOTEWORTHY = 0.01  # m; lake beds raised by less, as by rounding, are not reported


class BaseError(MapError):
    """A base cannot be read or made; the message is one line."""


class Base(NamedTuple):
    """The ground and the solids that a map is generated on."""

    heights: NDArray[np.float64] | None  # (R + 1, C + 1) m, row after row northwards; None: flat, at height 0
    water_level: float  # m, -inf without water
    solids: tuple[Solid, ...]  # in the frame of the map: its middle is the origin
    size: int  # m, of each side
    name: str


def folders() -> list[Path]:
    """Return the folders that hold bases: those in WILDSCAV_MAPS, else one in the user's data folder.

    Raises:
        MapError: None is named, and the user has no home directory.
    """
    if named := [Path(folder) for folder in os.environ.get("WILDSCAV_MAPS", "").split(os.pathsep) if folder]:
        return named
    try:
        return [Path(os.environ.get("XDG_DATA_HOME") or Path.home() / ".local/share") / "wildscav" / "maps"]
    except RuntimeError:
        raise MapError("this user has no home directory: name a folder for maps in WILDSCAV_MAPS") from None


def load_base(digest: str) -> Base:
    """Return the base with a digest.

    Raises:
        MapError: It is missing or damaged, or its content does not have this digest.
    """
    for folder in folders():
        path = folder / f"{digest}{SUFFIX}"
        if path.is_file():
            try:
                base = read_base(path)
            except BaseError as error:
                raise BaseError(f"base is {digest}: {error}") from None
            if digest_of(base) != digest:
                raise BaseError(f"base is {digest}: {path} holds another map ({digest_of(base)})")
            return base
    places = os.pathsep.join(str(folder) for folder in folders())
    raise BaseError(
        f"base is {digest}: no imported map with this digest in {places}; "
        "bring it in with: wildscav map import"
    )


def save_base(base: Base) -> tuple[str, Path]:
    """Write a base into the first of the folders; return its digest and its path.

    Raises:
        BaseError: No map can be generated on it.
        OSError: It cannot be written.
    """
    check_base(base)
    digest = digest_of(base)
    path = folders()[0] / f"{digest}{SUFFIX}"
    path.parent.mkdir(parents=True, exist_ok=True)
    write_whole(path, encode(base))
    return digest, path


def digest_of(base: Base) -> str:
    """Return the digest of a base's whole content, 32 hexadecimal digits."""
    digest = blake2b(canonical_json(_header(base)), digest_size=16)
    digest.update(_arrays(base))
    return digest.hexdigest()


def encode(base: Base) -> bytes:
    """Return a base as bytes."""
    return pack(LAYOUT, _header(base), zlib.compress(_arrays(base), 6))


def read_base(path: Path) -> Base:
    """Read a base.

    Raises:
        BaseError: The file is missing, no base, of another version, cut short, damaged or too large.
    """
    try:
        data = read_limited(path, FILE_LIMIT)
    except OSError as error:
        raise BaseError(f"{path}: cannot be read: {error.strerror}") from None
    try:
        return decode(data)
    except BaseError as error:
        raise BaseError(f"{path}: {error}") from None


def decode(data: bytes) -> Base:
    """Decode a base from bytes.

    Raises:
        BaseError: The bytes are not a valid base.
    """
    if len(data) > FILE_LIMIT:
        raise BaseError(f"more than {FILE_LIMIT} bytes")
    try:
        base = _assemble(*unpack(LAYOUT, data))
    except BinaryFormatError as error:
        raise BaseError(str(error)) from None
    except (ValueError, KeyError, TypeError, OverflowError, RecursionError, zlib.error) as error:
        raise BaseError(f"its contents are not valid: {error}") from None
    check_base(base)
    return base


def check_base(base: Base) -> None:
    """Check that maps can be generated on a base.

    Raises:
        BaseError: They cannot; the message says why.
    """
    size, level = base.size, base.water_level
    if not (SMALLEST <= size <= LARGEST and size % 2 == 0):
        raise BaseError(f"size is {size}, must be an even number of metres from {SMALLEST} to {LARGEST}")
    if level != -np.inf and not LOWEST <= level <= HIGHEST:
        raise BaseError(f"the water level is {level} m, must be from {LOWEST:g} to {HIGHEST:g}")
    if len(base.name) > NAME_LIMIT:
        raise BaseError(f"its name has {len(base.name)} characters, {NAME_LIMIT} are allowed")
    points = round(size / CELL) + 1
    if base.heights is not None:
        if base.heights.shape != (points, points):
            raise BaseError(f"its ground is {base.heights.shape}, must be {(points, points)}")
        if not ((base.heights >= LOWEST) & (base.heights <= HIGHEST)).all():
            raise BaseError(f"its ground is not everywhere from {LOWEST:g} to {HIGHEST:g} m")
    _check_solids(base.solids, size)


def _check_solids(solids: Sequence[Solid], size: int) -> None:
    if len(solids) > MAX_SOLIDS:
        raise BaseError(f"{len(solids)} parts, {MAX_SOLIDS} are allowed")
    if not solids:
        return
    faces = np.array([len(solid.planes) for solid in solids])
    if not ((faces >= 4) & (faces <= MAX_FACES)).all():
        raise BaseError(f"a part has {faces.min()} to {faces.max()} faces, must have 4 to {MAX_FACES}")
    planes = np.concatenate([solid.planes for solid in solids])
    low = np.array([solid.low for solid in solids])
    high = np.array([solid.high for solid in solids])
    squares = planes[:, 0] ** 2 + planes[:, 1] ** 2 + planes[:, 2] ** 2
    if not ((np.abs(squares - 1.0) < UNIT) & np.isfinite(planes[:, 3])).all():
        raise BaseError("a face of a part has no unit normal")
    if not (low < high).all():
        raise BaseError("a part has no volume")
    reach = size / 2 + OVERHANG
    least, most = np.array([-reach, LOWEST, -reach]), np.array([reach, HIGHEST, reach])
    middle = np.abs((low + high) / 2)[:, [0, 2]]
    if not ((low >= least).all() and (high <= most).all() and (middle <= size / 2).all()):
        raise BaseError(f"a part lies outside the map of {size} m")
    cells = ((high[:, 0] - low[:, 0]) / CELL + 2) * ((high[:, 2] - low[:, 2]) / CELL + 2)
    if cells.sum() > MAX_CELLS:
        raise BaseError(f"its parts cover {cells.sum():.0f} cells of 2 m, {MAX_CELLS} are allowed")


def _header(base: Base) -> dict[str, Any]:
    return {
        "name": base.name,
        "size": base.size,
        "water_level": None if base.water_level == -np.inf else base.water_level,
        "ground": base.heights is not None,
        "kinds": [int(solid.kind) for solid in base.solids],
        "faces": [len(solid.planes) for solid in base.solids],
    }


def _arrays(base: Base) -> bytes:
    parts = [] if base.heights is None else [base.heights]
    parts += [solid.planes for solid in base.solids]
    parts += [solid.low for solid in base.solids] + [solid.high for solid in base.solids]
    return b"".join(part.astype("<f8").tobytes() for part in parts)


def _assemble(header: dict[str, Any], packed: memoryview) -> Base:
    """Build a base from its header and arrays; refuse arrays that are larger than a file may be."""
    if set(header) != HEADER_KEYS:
        raise ValueError(f"its header has the keys {sorted(header)}, must have {sorted(HEADER_KEYS)}")
    size, kinds = int(header["size"]), [Kind(kind) for kind in header["kinds"]]
    faces = [int(count) for count in header["faces"]]
    if len(kinds) != len(faces) or len(kinds) > MAX_SOLIDS or not set(kinds) <= set(KINDS):
        raise ValueError(f"{len(kinds)} kinds of {len(faces)} solids")
    points = round(size / CELL) + 1 if header["ground"] else 0
    counts = np.cumsum([points * points, 4 * sum(faces), 3 * len(faces), 3 * len(faces)])
    if 8 * int(counts[-1]) > FILE_LIMIT:
        raise ValueError(f"they are more than {FILE_LIMIT} bytes")
    numbers = np.frombuffer(decompress(packed, 8 * int(counts[-1])), "<f8").astype(np.float64, copy=False)
    ground, planes, low, high = np.split(numbers, counts[:-1])
    each = np.split(planes.reshape(-1, 4), np.cumsum(faces)[:-1]) if faces else []
    corners = zip(kinds, each, low.reshape(-1, 3), high.reshape(-1, 3), strict=True)
    level = header["water_level"]
    return Base(
        heights=ground.reshape(points, points) if header["ground"] else None,
        water_level=-np.inf if level is None else float(level),
        solids=tuple(Solid(*corner) for corner in corners),
        size=size,
        name=str(header["name"]),
    )


class Imported(NamedTuple):
    """A base, and notes on what was changed or left out."""

    base: Base
    notes: tuple[str, ...]  # one line each


def finish(base: Base, notes: list[str]) -> Imported:
    """Limit the depth of a base's lakes and check the base.

    Raises:
        BaseError: No map can be made on it.
    """
    base = base._replace(name="".join(filter(str.isprintable, base.name))[:NAME_LIMIT])
    ground = np.zeros(1) if base.heights is None else base.heights
    if ground.max() <= base.water_level:
        raise BaseError(
            f"the water level is {base.water_level:g} m, but the highest ground is at {ground.max():g} m"
        )
    if base.heights is not None:
        depth = float(base.water_level - base.heights.min())
        base = base._replace(heights=np.maximum(base.heights, base.water_level - DEEPEST_WATER))
        if depth > DEEPEST_WATER + NOTEWORTHY:
            notes = [
                *notes,
                f"lake beds up to {depth:.1f} m deep are raised to {DEEPEST_WATER} m: agents wade, not swim",
            ]
    check_base(base)
    return Imported(base, tuple(notes))
