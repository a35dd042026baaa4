"""Maps that were made before, kept on disk.

A file is named after all that its map is a function of: the spec, the generator's version and a digest of the
generator's sources, so that an edited generator never gives the maps of the one before. What is damaged,
cannot be read or cannot be written is no error: the map is made again.

It holds the fields of ``GameMap`` as their types say, so a new field needs no change here: arrays as they
are, everything else as JSON. Uncompressed, because to inflate a map takes longer than to make it.
"""

import contextlib
import functools
import os
import time
import types
from collections.abc import Sequence
from dataclasses import is_dataclass
from enum import Enum
from hashlib import blake2b
from pathlib import Path
from typing import Any, Union, get_args, get_origin, get_type_hints

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.cache_folders import cache_root
from wildscav_engine.compilation.sources import sources_digest
from wildscav_engine.maps import generate
from wildscav_engine.maps.game_map import GENERATOR_VERSION, GameMap
from wildscav_engine.maps.generate import generate_map
from wildscav_engine.specs.base import Spec
from wildscav_engine.specs.map_spec import MapSpec
from wildscav_engine.storage.binary_format import ContainerError, Layout, canonical, pack, unpack
from wildscav_engine.storage.files import write_whole

LAYOUT = Layout(b"WILDSMAP", 1, "a cached map")
ROOM = 1_000_000_000  # bytes that all kept maps may take; the longest unused go first
WORTH_KEEPING = 0.05  # s; a map that takes less to make is soon made again


@functools.lru_cache(maxsize=8)
def map_of(spec: MapSpec) -> GameMap:
    """Return the map of a spec; the last few are remembered, and many more are kept on disk.

    Raises:
        MapError: As ``generate_map``.
    """
    game_map = load_cached(spec)
    if game_map is None:
        began = time.perf_counter()
        game_map = generate_map(spec.config, spec.seed)
        if time.perf_counter() - began > WORTH_KEEPING:
            store(game_map)
    return game_map


def load_cached(spec: MapSpec) -> GameMap | None:
    """Return the map of a spec if it was kept and is whole."""
    path = path_of(spec)
    try:
        header, payload = unpack(LAYOUT, path.read_bytes())
    except (OSError, ContainerError):
        return None
    with contextlib.suppress(OSError):
        os.utime(path)  # used just now; a cache that cannot be written is read all the same
    try:
        arrays = _read_arrays(header["arrays"], payload)
        game_map: GameMap = _value(GameMap, header["map"], arrays)
    except (ValueError, KeyError, TypeError, IndexError):
        return None
    if game_map.spec != spec:
        return None
    # Worked out when the map was kept, and whole as the rest of the file is: to do it again takes as long as
    # all of the reading.
    vars(game_map)["digest"] = header["digest"]
    return game_map


def store(game_map: GameMap) -> None:
    """Keep a map, if it can be kept, and give up the longest unused ones if they take too much room."""
    arrays: dict[int, NDArray[Any]] = {}
    fields = _stored(game_map, arrays)
    header = {
        "digest": game_map.digest,
        "map": fields,
        "arrays": [[array.dtype.str, array.shape] for array in arrays.values()],
    }
    content = pack(LAYOUT, header, *(_bytes_of(array) for array in arrays.values()))
    path = path_of(game_map.spec)
    with contextlib.suppress(OSError):
        path.parent.mkdir(parents=True, exist_ok=True)
        write_whole(path, content)
        _make_room(path.parent)


def path_of(spec: MapSpec) -> Path:
    """Return where the map of a spec is kept."""
    made_from = {
        "spec": spec.model_dump(mode="json"),
        "generator_version": GENERATOR_VERSION,
        "sources": _sources(),
    }
    return folder() / f"{blake2b(canonical(made_from), digest_size=16).hexdigest()}.map"


def folder() -> Path:
    """Return the folder of all kept maps, beside that of the compiled code."""
    return cache_root().parent / "maps"


@functools.cache
def _sources() -> str:
    return sources_digest(Path(generate.__file__))


def _make_room(kept: Path) -> None:
    """Remove the longest unused files until the others fit; other processes may do the same meanwhile."""
    files = []
    for path in kept.iterdir():
        with contextlib.suppress(OSError):
            status = path.stat()
            files.append((status.st_mtime, path, status.st_size))
    taken = sum(size for _, _, size in files)
    for _, path, size in sorted(files):
        if taken <= ROOM:
            return
        with contextlib.suppress(OSError):
            path.unlink()
        taken -= size


def _bytes_of(array: NDArray[Any]) -> memoryview:
    return np.ascontiguousarray(array).reshape(-1).view(np.uint8).data


def _read_arrays(table: Sequence[tuple[str, list[int]]], payload: memoryview) -> list[NDArray[Any]]:
    """Return the arrays one after the other in a payload, each with memory of its own."""
    arrays, start = [], 0
    for name, shape in table:
        dtype = np.dtype(name)
        count = int(np.prod(shape, dtype=np.int64))
        array = np.frombuffer(payload, dtype, count, start).reshape(shape).copy()
        arrays.append(array)
        start += array.nbytes
    return arrays


def _stored(value: Any, arrays: dict[int, NDArray[Any]]) -> Any:
    """Return a value as JSON has it; its arrays are put aside, each once, for their numbers."""
    if isinstance(value, np.ndarray):
        arrays.setdefault(id(value), value)
        return list(arrays).index(id(value))
    if isinstance(value, Spec):
        return value.model_dump(mode="json")
    kind: Any = type(value)
    if _has_fields(kind):
        return {name: _stored(getattr(value, name), arrays) for name in _fields(kind)}
    if isinstance(value, tuple | list):
        return [_stored(item, arrays) for item in value]
    return value.value if isinstance(value, Enum) else value


def _value(kind: Any, stored: Any, arrays: list[NDArray[Any]]) -> Any:
    """Return the value of a type that ``_stored`` gave."""
    origin, arguments = get_origin(kind), get_args(kind)
    if origin is np.ndarray:
        return arrays[stored]
    if origin in {Union, types.UnionType}:  # with None
        return None if stored is None else _value(arguments[0], stored, arrays)
    if origin is list or (origin is tuple and arguments[-1] is Ellipsis):
        return origin(_value(arguments[0], item, arrays) for item in stored)
    if origin is tuple:
        return tuple(_value(one, item, arrays) for one, item in zip(arguments, stored, strict=True))
    if _has_fields(kind):
        return kind(**{name: _value(one, stored[name], arrays) for name, one in _fields(kind).items()})
    if issubclass(kind, Spec):
        return kind.model_validate(stored)
    return kind(stored)


def _has_fields(kind: Any) -> bool:
    """Return whether a type is a named tuple or a dataclass."""
    return hasattr(kind, "_fields") or is_dataclass(kind)


@functools.cache
def _fields(kind: Any) -> dict[str, Any]:
    """Return the fields of a named tuple or a dataclass with their types, in order."""
    hints = get_type_hints(kind)
    names = getattr(kind, "_fields", None) or kind.__dataclass_fields__
    return {name: hints[name] for name in names}
