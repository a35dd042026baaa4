"""Maps made at once are the same as one by one; other processes make some where it is worth it."""

import subprocess
import sys
import threading
import time
from pathlib import Path
from typing import Any

import pytest

from wildscav_engine.compilation import notice
from wildscav_engine.compilation.caching.cache_root import cache_root
from wildscav_engine.compilation.caching.locks import Lock
from wildscav_engine.maps import MapError, cache, generate_map, making
from wildscav_engine.maps.pools import MapPool
from wildscav_engine.specs.map_spec import MapConfig, MapSpec

MAPS = {number: [MapSpec(config=MapConfig(size=40, houses=0), seed=number)] for number in range(6)}
CROWDED = MapSpec(config=MapConfig(size=40, houses=50))


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, compiled: None) -> Path:
    """An empty folder of maps, beside the compiled code that there is."""
    (tmp_path / "kernels").symlink_to(cache_root())
    monkeypatch.setenv("WILDSCAV_CACHE_DIR", str(tmp_path))
    monkeypatch.delenv("WILDSCAV_QUIET", raising=False)
    monkeypatch.setattr(making, "cores", lambda: 2)
    cache.map_of.cache_clear()
    return tmp_path / "maps"


def test_the_maps_of_other_processes_are_the_same(monkeypatch: pytest.MonkeyPatch, folder: Path) -> None:
    monkeypatch.setattr(making, "WORTH", 1e-9)
    here: list[int] = []

    def make(number: int) -> None:
        """Leave some maps to others."""
        here.append(number)
        if len(here) == 3:
            while not list(folder.glob("*.map")):
                time.sleep(0.05)

    making.make_maps(MAPS, make)

    assert sorted(here + [n for n, specs in MAPS.items() if cache.path_of(specs[0]).exists()]) == list(MAPS)
    kept = cache.load_cached(MAPS[5][0])
    assert kept is not None
    assert kept.digest == generate_map(MAPS[5][0].config, 5).digest
    assert making.THREAD not in [thread.name for thread in threading.enumerate()]


@pytest.mark.parametrize(
    ("cores", "worth", "others"),
    [(1, 1e-9, False), (2, 1e9, False), (2, 1e-9, True)],
    ids=["one core", "not worth it", "another program makes maps"],
)
def test_maps_are_made_here_alone(
    monkeypatch: pytest.MonkeyPatch, cores: int, worth: float, others: bool
) -> None:
    lock = Lock(cache_root() / "making.lock")
    assert not others or lock.take()
    monkeypatch.setattr(making, "cores", lambda: cores)
    monkeypatch.setattr(making, "WORTH", worth)
    monkeypatch.setattr("subprocess.Popen", None)
    here: list[int] = []
    making.make_maps(MAPS, here.append)
    lock.release()
    assert here == list(MAPS)


def test_after_an_error_no_other_process_is_left(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(making, "WORTH", 1e-9)
    pool = MapPool(7, [*MAPS.values(), [CROWDED]][::-1].__getitem__)
    with pytest.raises(MapError, match="houses is 50"):
        pool.prepare([3, 4, 0, 1])
    assert making.THREAD not in [thread.name for thread in threading.enumerate()]
    assert not pool.is_made


def test_people_who_wait_are_told_how_many_are_made(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(notice, "MOMENT", 0.0)
    monkeypatch.setattr(notice, "PAUSE", 0.0)
    lines = [f"wildscav: made {made} of 6 maps, which are kept for the next time" for made in range(1, 6)]
    end = "wildscav: made 6 maps, after 0 s"
    making.make_maps(MAPS, lambda _: None)
    assert capsys.readouterr().err.splitlines() == [lines[0], end]  # a pipe, such as that of a notebook

    monkeypatch.setattr(sys.stderr, "isatty", lambda: True, raising=False)
    making.make_maps(MAPS, lambda _: None)
    assert capsys.readouterr().err.splitlines() == [*lines, end]
    shown: list[notice.Progress] = []
    with notice.progress_callback(shown.append):
        making.make_maps(MAPS, lambda _: None)
    assert [progress.maps for progress in shown] == [f"{made}/6" for made in range(1, 7)]


def other_process(monkeypatch: pytest.MonkeyPatch, folder: Path, code: str) -> None:
    """Let another process, which has a half-written map, run some code in place of making maps."""
    monkeypatch.setattr(making, "WORTH", 1e-9)
    start = subprocess.Popen
    folder.mkdir(exist_ok=True)

    def started(_: object, **options: Any) -> Any:
        process = start([sys.executable, "-c", code], **options)
        (folder / f".0123.map.{process.pid}.part").write_bytes(b"half")
        return process

    monkeypatch.setattr("subprocess.Popen", started)


def test_a_map_that_another_process_is_still_making_does_not_count(
    monkeypatch: pytest.MonkeyPatch, folder: Path
) -> None:
    asked = folder / "asked"
    other_process(monkeypatch, folder, f"print(flush=True); input(); open({str(asked)!r}, 'x')")
    here: list[int] = []

    def make(number: int) -> None:
        here.append(number)
        while len(here) == 3 and not asked.exists():
            time.sleep(0.05)

    shown: list[notice.Progress] = []
    with notice.progress_callback(shown.append):
        making.make_maps(MAPS, make)
    assert here == [0, 1, 2, 3, 4]
    assert [progress.maps for progress in shown] == [f"{made}/6" for made in range(1, 6)]


def test_nothing_is_left_of_a_map_that_a_killed_process_was_writing(
    monkeypatch: pytest.MonkeyPatch, folder: Path
) -> None:
    other_process(monkeypatch, folder, "import time; time.sleep(60)")
    making.make_maps(MAPS, lambda _: None)
    assert not list(folder.iterdir())
