"""Files rendered from records: what they hold, that each is rendered once, and what crashes leave."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from datetime import UTC, datetime, timedelta
from pathlib import Path

import pytest
from rerun.chunk import RrdReader

from wildscav.errors import UserError
from wildscav_engine.maps import map_of
from wildscav_engine.record import RecordError, read_record
from wildscav_engine.record.format import save
from wildscav_engine.specs.map_spec import MapSpec
from wildscav_leaderboard.spectating.render import render_map
from wildscav_leaderboard.spectating.render_cache import PRODUCTS, RenderCache, Rendering
from wildscav_stage.scene.map_file import map_file
from wildscav_stage.scene.trails import trails_of

NOW = datetime(2030, 1, 1, tzinfo=UTC)
PATIENCE = 120.0  # s
Records = Callable[[str], Path]


@pytest.fixture
def cache(tmp_path: Path) -> Iterator[RenderCache]:
    with RenderCache(tmp_path / "rendered") as cache:
        yield cache


class QuickCache(RenderCache):
    """Writes a kilobyte for each file, in its own process, and counts."""

    rendered = 0

    def _render(self, record: Path, wanted: dict[str, Path], lock: int) -> None:
        for target in wanted.values():
            target.write_bytes(bytes(1000))
            QuickCache.rendered += 1


def wait_for(
    cache: RenderCache, product: str, key: str, record: Path | MapSpec, now: datetime = NOW
) -> Rendering:
    """Ask for a file again and again, as a page does, until it is ready or has failed."""
    end = time.monotonic() + PATIENCE
    while (progress := cache.progress(product, key, record, now)).state in ("waiting", "rendering"):
        if time.monotonic() > end:
            pytest.fail(f"{product} of {key} is still {progress.state}")
        time.sleep(0.05)
    return progress


def wait_until_rendering(cache: RenderCache, key: str, record: Path) -> int:
    """Wait until a replay is being rendered, and return the renderer's process."""
    end = time.monotonic() + PATIENCE
    while not cache._running:
        cache.progress("replay", key, record, NOW)
        assert time.monotonic() < end
        time.sleep(0.01)
    return next(iter(cache._running)).pid


def kept(cache: RenderCache) -> set[str]:
    return {path.name.partition(".")[0] for path in cache.folder.iterdir() if path.is_file()}


def left_in_slots(folder: Path) -> list[Path]:
    return [path for path in folder.glob(".slots/*/*") if path.is_file()]


def test_another_map_than_that_of_the_match_is_not_drawn(record_of_track: Records, tmp_path: Path) -> None:
    """After a change of the generator, trails of old matches may be there still, and their maps gone."""
    record = tmp_path / "old.wsr"
    save(replace(read_record(record_of_track("battle")), map_digest="0" * 32), record)

    with pytest.raises(RecordError, match="another map"):
        render_map(record, tmp_path / "map.gz")

    assert not (tmp_path / "map.gz").exists()


@pytest.mark.slow
def test_the_map_of_a_match_without_a_record_is_made_from_its_spec(
    cache: RenderCache, record_of_track: Records
) -> None:
    spec = read_record(record_of_track("battle")).spec.map

    game_map = wait_for(cache, "map", "m1", spec)

    assert game_map.path is not None
    assert game_map.path.read_bytes() == map_file(map_of(spec))
    assert [path for path in cache.folder.iterdir() if path.is_file()] == [game_map.path]


def test_servers_that_share_the_folder_render_a_file_once(tmp_path: Path) -> None:
    before = QuickCache.rendered
    with QuickCache(tmp_path / "shared") as one, QuickCache(tmp_path / "shared") as other:
        for _ in range(5):
            one.progress("replay", "m1", Path("any.wsr"), NOW)
            other.progress("replay", "m1", Path("any.wsr"), NOW)
        wait_for(one, "replay", "m1", Path("any.wsr"))
        for cache in (one, other):
            cache.close()  # waits for what is still queued
    assert QuickCache.rendered == before + 1


def test_the_least_recently_used_goes_first(tmp_path: Path) -> None:
    record = Path("any.wsr")
    with QuickCache(tmp_path / "full", limit=4500) as cache:  # room for four files
        for key in ("m1", "m2"):
            wait_for(cache, "trails", key, record)
        for product, key in (("trails", "m2"), ("map", "m1")):  # used again
            cache.progress(product, key, record, NOW)

        wait_for(cache, "trails", "m3", record)

        names = {path.name.partition("-")[0] for path in cache.folder.iterdir() if path.is_file()}
    assert names == {"m2.trails", "m1.map", "m3.trails", "m3.map"}


def test_a_file_larger_than_the_cache_is_refused(tmp_path: Path) -> None:
    with QuickCache(tmp_path / "tiny", limit=100) as cache:
        progress = wait_for(cache, "trails", "m1", Path("any.wsr"))

        assert progress.state == "failed"
        assert "100 are allowed" in progress.detail
        assert kept(cache) == set()


@pytest.mark.slow
def test_a_failure_says_why_and_is_tried_again_later_for_all_that_a_page_needs_by_one_process(
    cache: RenderCache, tmp_path: Path, record_of_track: Records
) -> None:
    record = tmp_path / "m1.wsr"
    record.write_bytes(b"no record")
    failed = wait_for(cache, "trails", "m1", record)
    record.write_bytes(record_of_track("battle").read_bytes())

    assert failed.state == "failed"
    assert failed.detail.startswith("the record: ")
    assert str(tmp_path) not in failed.detail
    assert cache.progress("trails", "m1", record, NOW + timedelta(minutes=4)).state == "failed"
    trails = wait_for(cache, "trails", "m1", record, NOW + timedelta(minutes=5))
    game_map = cache.progress("map", "m1", Path("gone.wsr"), NOW + timedelta(minutes=5))
    assert trails.path is not None
    assert game_map.path is not None
    assert trails.path.read_bytes() == trails_of(read_record(record)).compressed()
    assert game_map.path.read_bytes() == map_file(map_of(read_record(record).spec.map))


@pytest.mark.parametrize(
    ("product", "key"), [("film", "m1"), ("trails", "../m1"), ("trails", ""), ("trails", "a" * 101)]
)
def test_names_that_are_none_are_refused(cache: RenderCache, product: str, key: str) -> None:
    with pytest.raises(UserError, match="no "):
        cache.progress(product, key, Path("any.wsr"), NOW)


def test_a_renderer_that_is_killed_leaves_nothing(cache: RenderCache, record_of_track: Records) -> None:
    record = record_of_track("battle")
    os.kill(wait_until_rendering(cache, "m1", record), signal.SIGKILL)

    progress = wait_for(cache, "replay", "m1", record)

    assert progress.state == "failed"
    assert "SIGKILL" in progress.detail
    assert kept(cache) == set()
    assert left_in_slots(cache.folder) == []


def test_a_closed_cache_stops_its_renderer_and_renders_no_more(
    cache: RenderCache, record_of_track: Records
) -> None:
    record = record_of_track("battle")
    renderer = wait_until_rendering(cache, "m1", record)

    cache.close()

    with pytest.raises(ProcessLookupError):
        os.kill(renderer, 0)
    assert "stopping" in cache.progress("trails", "m2", record, NOW).detail
    assert kept(cache) == set()


SERVER = """
import sys, time
from datetime import UTC, datetime
from pathlib import Path
from wildscav_leaderboard.spectating.render_cache import RenderCache
cache = RenderCache(Path(sys.argv[1]))
while not cache._running:
    cache.progress("replay", "m1", Path(sys.argv[2]), datetime(2030, 1, 1, tzinfo=UTC))
print("rendering", flush=True)
time.sleep(600)
"""


@pytest.mark.slow
def test_after_a_server_was_killed_the_next_one_renders_a_replay_that_is_waited_for_and_then_opens(
    tmp_path: Path, record_of_track: Records
) -> None:
    folder, record = tmp_path / "rendered", record_of_track("capture")
    arguments = [sys.executable, "-c", SERVER, str(folder), str(record)]
    with subprocess.Popen(arguments, stdout=subprocess.PIPE, text=True) as server:
        assert server.stdout is not None
        assert server.stdout.readline() == "rendering\n"
        server.kill()
    with RenderCache(folder) as cache:
        first = cache.progress("replay", "m1", record, NOW)
        ready = wait_for(cache, "replay", "m1", record)
        assert left_in_slots(folder) == []
    assert first.state in ("waiting", "rendering")
    assert first.detail
    assert ready.state == "ready"
    assert ready.path is not None
    assert "/agents/seat_0" in RrdReader(ready.path).store().schema().entity_paths()


def test_a_change_of_what_is_rendered_changes_the_names_of_files() -> None:
    endings = {product.ending for product in PRODUCTS.values()}

    assert len(endings) == len(PRODUCTS)
    assert all(any(letter.isdigit() for letter in ending) for ending in endings)
