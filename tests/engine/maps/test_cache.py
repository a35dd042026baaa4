"""Cached maps: the same as generated ones, and never outdated or damaged."""

import dataclasses
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from wildscav_engine.maps import cache, generate_map
from wildscav_engine.maps.game_map import GameMap
from wildscav_engine.specs.map_spec import MapConfig, MapSpec


@pytest.fixture(scope="module")
def country() -> GameMap:
    return generate_map(MapConfig(size=60, houses=2, water=0.1), 4)


@pytest.fixture(autouse=True)
def kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The folder of cached maps."""
    monkeypatch.setattr(cache, "folder", lambda: tmp_path / "maps")
    cache.map_of.cache_clear()
    return tmp_path / "maps"


def test_a_kept_map_is_the_map_that_was_made(country: GameMap) -> None:
    cache.store(country)
    again = cache.load_cached(country.spec)

    assert again is not None
    assert again.digest == country.digest == dataclasses.replace(again).digest  # computed anew
    assert (again.spec, again.houses) == (country.spec, country.houses)
    assert again.houses[0].wings == country.houses[0].wings
    for array in (*again.world, again.indoor, again.outdoor, again.solid_house):
        assert array.flags.c_contiguous
        assert array.flags.writeable
        assert array.flags.aligned


def test_a_map_is_made_once(country: GameMap, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cache, "CACHE_THRESHOLD", 0.0)
    first = cache.map_of(country.spec)
    cache.map_of.cache_clear()
    monkeypatch.setattr(cache, "generate_map", None)

    assert cache.map_of(country.spec).digest == first.digest
    assert cache.map_of(country.spec) is cache.map_of(country.spec.model_copy())


def test_a_map_that_is_soon_made_is_not_kept(
    country: GameMap, kept: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(cache, "generate_map", lambda config, seed: country)
    cache.map_of(country.spec)

    assert not kept.exists()


def test_every_spec_has_a_file_of_its_own(country: GameMap) -> None:
    config = country.spec.config
    specs = [country.spec, MapSpec(config=config, seed=5), MapSpec(config=MapConfig(size=62), seed=4)]
    specs.append(MapSpec(config=config.model_copy(update={"base": "0" * 32}), seed=4))

    assert len({cache.path_of(spec) for spec in specs}) == 4


def test_another_spec_or_generator_gets_no_maps_of_this_one(
    country: GameMap, monkeypatch: pytest.MonkeyPatch
) -> None:
    other = MapSpec(config=country.spec.config, seed=5)
    cache.store(country)
    for name, value in (("GENERATOR_VERSION", 10**6), ("_sources", lambda: "an edited generator")):
        with monkeypatch.context() as edited:
            edited.setattr(cache, name, value)
            assert cache.load_cached(country.spec) is None
    cache.path_of(country.spec).rename(cache.path_of(other))

    assert cache.load_cached(other) is None


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.data())
def test_damage_is_noticed(country: GameMap, data: st.DataObject) -> None:
    cache.store(country)
    path = cache.path_of(country.spec)
    raw = bytearray(path.read_bytes())
    if data.draw(st.booleans()):
        raw = raw[: data.draw(st.integers(0, len(raw) - 1))]
    else:
        raw[data.draw(st.integers(0, len(raw) - 1))] ^= data.draw(st.integers(1, 255))
    path.write_bytes(raw)

    assert cache.load_cached(country.spec) is None


@pytest.mark.parametrize(
    "change",
    [
        {"arrays": []},
        {"arrays": [["<f8", [10**12]]]},
        {"arrays": [["nonsense", [1]]]},
        {"arrays": 7},
        {"map": {}},
        {"map": []},
    ],
)
def test_a_file_of_another_making_is_not_taken(country: GameMap, change: dict[str, object]) -> None:
    cache.store(country)
    path = cache.path_of(country.spec)
    header, payload = cache.unpack(cache.LAYOUT, path.read_bytes())
    path.write_bytes(cache.pack(cache.LAYOUT, {**header, **change}, payload))

    assert cache.load_cached(country.spec) is None


def test_a_damaged_file_is_made_again(country: GameMap, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cache, "CACHE_THRESHOLD", 0.0)
    cache.store(country)
    path = cache.path_of(country.spec)
    whole = path.read_bytes()
    path.write_bytes(whole[:-1])

    assert cache.map_of(country.spec).digest == country.digest
    assert path.read_bytes() == whole


def test_without_a_writable_folder_maps_are_made(country: GameMap, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cache, "CACHE_THRESHOLD", 0.0)
    monkeypatch.setattr(cache, "folder", lambda: Path("/dev/null/nowhere"))

    assert cache.map_of(country.spec).digest == country.digest


def test_the_longest_unused_maps_go_first(
    country: GameMap, kept: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    cache.store(country)
    size = cache.path_of(country.spec).stat().st_size
    monkeypatch.setattr(cache, "SIZE_LIMIT", int(3.5 * size))
    names = []
    for age in (30, 20, 10):
        names.append(kept / f"old-{age}.map")
        names[-1].write_bytes(bytes(size))
        os.utime(names[-1], (1e9 - age, 1e9 - age))
    os.utime(cache.path_of(country.spec), (1e8, 1e8))

    assert cache.load_cached(country.spec) is not None  # used, so it is no longer the oldest
    cache._evict(kept)

    assert [path.exists() for path in names] == [False, True, True]
    assert cache.path_of(country.spec).exists()


@pytest.mark.slow
def test_two_processes_may_keep_and_take_the_same_maps(kept: Path) -> None:
    code = f"""
from pathlib import Path
from wildscav_engine.maps import cache
from wildscav_engine.specs.map_spec import MapConfig, MapSpec
cache.folder = lambda: Path({str(kept)!r})
cache.CACHE_THRESHOLD, cache.SIZE_LIMIT = 0.0, 700_000  # room for a few
for number in range(12):
    spec = MapSpec(config=MapConfig(size=50, houses=1), seed=number % 6)
    cache.map_of.cache_clear()
    print(cache.map_of(spec).digest)
"""
    pipes: dict[str, Any] = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    runs = [subprocess.Popen([sys.executable, "-c", code], **pipes) for _ in range(2)]
    outputs = [run.communicate(timeout=120) for run in runs]
    right = [generate_map(MapConfig(size=50, houses=1), seed).digest for seed in range(6)] * 2

    assert [error for _, error in outputs] == ["", ""]
    assert [output.split() for output, _ in outputs] == [right, right]
    assert not list(kept.glob("*.part"))


def test_arrays_in_two_fields_or_not_contiguous_come_back_with_their_numbers(country: GameMap) -> None:
    turned = country.world._replace(heights=np.asfortranarray(country.world.heights))
    cache.store(dataclasses.replace(country, world=turned, indoor=country.outdoor))
    again = cache.load_cached(country.spec)

    assert again is not None
    assert again.indoor is again.outdoor
    assert np.array_equal(again.world.heights, country.world.heights)
