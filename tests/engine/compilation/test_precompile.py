"""What is compiled ahead is what matches and depth maps run, and processes do not compile it twice."""

import subprocess
import sys
import textwrap
from pathlib import Path

import pytest

from wildscav_engine.compilation import precompile as ahead
from wildscav_engine.compilation.kernel import PLAIN

pytestmark = pytest.mark.skipif(PLAIN, reason="nothing is compiled")


def run(code: str) -> str:
    """Return what a new process prints."""
    done = subprocess.run(
        [sys.executable, "-c", textwrap.dedent(code)], check=True, stdout=subprocess.PIPE, text=True
    )
    return done.stdout


@pytest.mark.slow
def test_what_is_compiled_ahead_plays_matches_and_makes_depth_maps() -> None:
    """It is closed to all other types, so a call that needed another one would fail."""
    said = run("""
        from wildscav_engine.compilation import precompile as ahead
        ahead.main()
        from wildscav_engine.maps import generate_map
        from wildscav_engine.simulation.match import Match
        from wildscav_engine.simulation.batch_kernels import play_batch
        from wildscav_engine.sensors import DepthCamera
        from wildscav_engine.specs.map_spec import MapConfig
        from wildscav_engine.specs.match_spec import MatchSpec

        game_map = generate_map(MapConfig(size=40, houses=0), 1)
        for seats in (("submission",), ("submission", "fighter")):
            match = Match(MatchSpec(track="battle", map=game_map.spec, seats=seats), game_map)
            match.step()
            print(DepthCamera(10, 10).read(match, range(len(seats))).shape)
        print(len(play_batch.outer.signatures))
    """)
    assert said.split("\n") == ["(1, 10, 10)", "(2, 10, 10)", "1", ""]


def test_nothing_is_compiled_ahead_where_it_is_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: object, **__: object) -> None:
        raise AssertionError("a process was started")

    ahead.main()
    monkeypatch.setattr("subprocess.Popen", refuse)
    ahead.compile_ahead.__wrapped__()


def test_with_nothing_kept_another_process_compiles(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    started: list[list[str]] = []
    monkeypatch.setattr(ahead, "cache_folder", lambda _: tmp_path)
    monkeypatch.setattr(ahead, "cores", lambda: 2)
    monkeypatch.setattr("subprocess.Popen", lambda command, **_: started.append(command))
    monkeypatch.setattr("atexit.register", lambda *_: None)

    ahead.compile_ahead.__wrapped__()

    assert started == [[sys.executable, "-m", "wildscav_engine.compilation.precompile"]]
