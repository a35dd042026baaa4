"""The cache of generated maps on disk.

The name of a file is a digest of everything that its map depends on: the spec, the generator's version and
the generator's sources, so an edited generator never returns maps of an earlier one. A file that is damaged
or cannot be read or written is no error: the map is generated again.

A file holds the fields of ``GameMap`` according to their types, so a new field needs no change here: arrays
in binary, everything else as JSON. It is not compressed, because decompressing a map takes longer than
generating it.
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

from wildscav_engine.compilation.caching.cache_root import cache_root
from wildscav_engine.compilation.caching.sources import sources_digest
from wildscav_engine.maps import generate
from wildscav_engine.maps.errors import MapError
from wildscav_engine.maps.game_map import GENERATOR_VERSION, GameMap
from wildscav_engine.maps.generate import generate_map
from wildscav_engine.specs.base import Spec
from wildscav_engine.specs.map_spec import MapSpec
from wildscav_engine.storage.binary_format import BinaryFormatError, Layout, canonical_json, pack, unpack
from wildscav_engine.storage.files import write_whole

LAYOUT = Layout(b"WILDSMAP", 1, "a cached map")
SIZE_LIMIT = 1_000_000_000  # bytes of all cached maps by default; the least recently used go first
LIMIT = "WILDSCAV_MAP_CACHE_MB"  # the environment variable with another limit
CACHE_THRESHOLD = 0.05  # s; maps that are generated faster than this are not cached


@functools.lru_cache(maxsize=8)
def map_of(spec: MapSpec) -> GameMap:
    """Return the map of a spec; the last few are cached in memory, and many more on disk.

    Raises:
        MapError: As ``generate_map``.
    """
    game_map = load_cached(spec)
    if game_map is None:
        began = time.perf_counter()
        game_map = generate_map(spec.config, spec.seed)
        if time.perf_counter() - began > CACHE_THRESHOLD:
            store(game_map)
    return game_map


def load_cached(spec: MapSpec) -> GameMap | None:
    """Return the map of a spec if an intact copy is cached, else None."""
    path = path_of(spec)
    try:
        header, payload = unpack(LAYOUT, path.read_bytes())
    except (OSError, BinaryFormatError):
        return None
    with contextlib.suppress(OSError):
        os.utime(path)  # marks it as just used; a read-only cache still works
    try:
        arrays = _read_arrays(header["arrays"], payload)
        game_map: GameMap = _value(GameMap, header["map"], arrays)
    except (ValueError, KeyError, TypeError, IndexError):
        return None
    if game_map.spec != spec:
        return None
    # Computed when the map was stored, and covered by the file's checksum: computing it again would take as
    # long as reading the file.
    vars(game_map)["digest"] = header["digest"]
    return game_map


def size_limit(variable: str, default: int) -> int:
    """Return how many bytes maps may take.

    Args:
        variable: The environment variable with the limit in megabytes.
        default: Bytes, without it.

    Raises:
        MapError: The environment variable is not a number of megabytes.
    """
    text = os.environ.get(variable)
    if text is None:
        return default
    if not text.isdecimal() or int(text) < 1:
        raise MapError(f"{variable} is {text!r}, must be a whole number of megabytes, at least 1")
    return int(text) * 1_000_000


def store(game_map: GameMap) -> None:
    """Cache a map on disk if possible, and remove the least recently used ones beyond the size limit."""
    store_packed(game_map.spec, packed(game_map))


def packed(game_map: GameMap) -> bytes:
    """Return a map as the content of a file of the cache."""
    arrays: dict[int, NDArray[Any]] = {}
    fields = _stored(game_map, arrays)
    header = {
        "digest": game_map.digest,
        "map": fields,
        "arrays": [[array.dtype.str, array.shape] for array in arrays.values()],
    }
    return pack(LAYOUT, header, *(_bytes_of(array) for array in arrays.values()))


def store_packed(spec: MapSpec, content: bytes) -> None:
    """Cache a map on disk as ``store`` does, given what ``packed`` returned for it, here or elsewhere."""
    path = path_of(spec)
    with contextlib.suppress(OSError):
        path.parent.mkdir(parents=True, exist_ok=True)
        write_whole(path, content)
        _evict(path.parent)


def path_of(spec: MapSpec) -> Path:
    """Return the path of a spec's map in the cache."""
    made_from = {
        "spec": spec.model_dump(mode="json"),
        "generator_version": GENERATOR_VERSION,
        "sources": _sources(),
    }
    return folder() / f"{blake2b(canonical_json(made_from), digest_size=16).hexdigest()}.map"


def folder() -> Path:
    """Return the folder of the cached maps, next to that of the compiled code."""
    return cache_root().parent / "maps"


@functools.cache
def _sources() -> str:
    return sources_digest(Path(generate.__file__))


def _evict(kept: Path) -> None:
    """Remove the least recently used files until the others fit; other processes may do so concurrently."""
    limit, files = size_limit(LIMIT, SIZE_LIMIT), []
    for path in kept.iterdir():
        with contextlib.suppress(OSError):
            status = path.stat()
            files.append((status.st_mtime, path, status.st_size))
    taken = sum(size for _, _, size in files)
    for _, path, size in sorted(files):
        if taken <= limit:
            return
        with contextlib.suppress(OSError):
            path.unlink()
        taken -= size


def _bytes_of(array: NDArray[Any]) -> memoryview:
    return np.ascontiguousarray(array).reshape(-1).view(np.uint8).data


def _read_arrays(table: Sequence[tuple[str, list[int]]], payload: memoryview) -> list[NDArray[Any]]:
    """Return copies of the consecutive arrays in a payload."""
    arrays, start = [], 0
    for name, shape in table:
        dtype = np.dtype(name)
        count = int(np.prod(shape, dtype=np.int64))
        array = np.frombuffer(payload, dtype, count, start).reshape(shape).copy()
        arrays.append(array)
        start += array.nbytes
    return arrays


def _stored(value: Any, arrays: dict[int, NDArray[Any]]) -> Any:
    """Return a value as JSON; each array in it is added to ``arrays`` once and replaced by its number."""
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
    """Return the value of a type from the output of ``_stored``."""
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
