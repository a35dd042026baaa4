"""Generating many maps at once, on this machine or on a cluster, into this machine's cache of maps."""

from collections.abc import Iterable, Iterator, Sequence
from typing import NamedTuple

from wildscav.errors import UserError
from wildscav.terminal.console import console, counted, print_json, progress_bar
from wildscav_engine.maps.cache import (
    LIMIT,
    SIZE_LIMIT,
    folder,
    load_cached,
    packed,
    size_limit,
    store_packed,
)
from wildscav_engine.maps.errors import MapError
from wildscav_engine.maps.generate import generate_map
from wildscav_engine.maps.levels import Level
from wildscav_engine.maps.pools import MapPool, Split, random_maps
from wildscav_engine.specs.map_spec import MapSpec
from wildscav_evaluator.executors import Executor
from wildscav_evaluator.suites.suite import Suite

Choices = tuple[MapSpec, ...]  # specs to try in turn; the first that can be generated is the map


class MadeMap(NamedTuple):
    """A map that was generated somewhere."""

    spec: MapSpec
    content: bytes  # as the cache keeps it; empty if it could not be generated
    error: str = ""  # why it could not be generated


def choices_of_pool(
    level: Level, split: Split, seed: int, count: int, *, unseen: bool = False
) -> list[Choices]:
    """Return the maps of a pool for training or testing, as ``random_maps`` returns it."""
    pool: MapPool = random_maps(level, split, seed, count, unseen=unseen)
    return [pool.specs(number) for number in range(count)]


def choices_of_suite(suite: Suite, tracks: Sequence[str], seed: int) -> list[Choices]:
    """Return the maps of a suite's matches, each once; of all tracks if none is named."""
    specs = dict.fromkeys(
        match.map for track in tracks or suite.tracks for match in suite.matches(track, seed)
    )
    return [(spec,) for spec in specs]


def missing_maps(choices: Iterable[Choices]) -> list[Choices]:
    """Return the maps that are not in this machine's cache."""
    return [specs for specs in choices if not any(load_cached(spec) is not None for spec in specs)]


def make_maps(choices: Iterable[Choices], executor: Executor) -> Iterator[MadeMap]:
    """Generate maps, put each into this machine's cache, and yield them in their order.

    UserError if one cannot be generated, or they do not all fit into the cache.
    """
    limit, taken = size_limit(LIMIT, SIZE_LIMIT), 0
    for made in executor.map(make_map, choices):
        if made.error:
            raise UserError(f"map with seed {made.spec.seed}: {made.error}", exit_code=2)
        taken += len(made.content)
        if taken > limit:
            raise UserError(
                f"the maps take more than {limit // 1_000_000:,} MB, which is all that the cache keeps: set "
                f"{LIMIT} to more megabytes, for this command and for those that use the maps"
            )
        store_packed(made.spec, made.content)
        yield made


def run_make_maps(choices: Sequence[Choices], executor: Executor, *, as_json: bool = False) -> None:
    """Make the maps that are not cached yet, and say how many and how large they are.

    UserError if one cannot be made, they do not fit into the cache, or the command was interrupted.
    """
    missing = missing_maps(choices)
    if len(missing) < len(choices):
        console.print(f"{len(choices) - len(missing):,} of {counted(len(choices), 'map')} were cached before")
    made, size = 0, 0
    with progress_bar() as progress:
        task = progress.add_task("making maps", total=len(missing))
        try:
            for one in make_maps(missing, executor):
                made, size = made + 1, size + len(one.content)
                progress.advance(task)
        except KeyboardInterrupt:
            raise UserError(f"interrupted: {made:,} of {counted(len(missing), 'map')} made", 130) from None
    console.print(f"made {counted(made, 'map')}, {size / 1e6:,.0f} MB, in {folder()}")
    if as_json:
        cached = len(choices) - len(missing)
        print_json({"made": made, "cached": cached, "bytes": size, "folder": str(folder())})


def make_map(specs: Choices) -> MadeMap:
    """Generate the first map that can be generated. This may run on another machine."""
    error = ""
    for spec in specs:
        try:
            return MadeMap(spec, packed(generate_map(spec.config, spec.seed)))
        except MapError as reason:
            error = str(reason)
    return MadeMap(specs[-1], b"", error)
