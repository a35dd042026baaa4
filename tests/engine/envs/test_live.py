"""The live view: what is sent to Rerun while an environment is played."""

from typing import Any, Literal

import pytest
import rerun as rr
from tests.engine.envs.common import options

from wildscav_engine.envs.single import SingleEnv
from wildscav_engine.view import live
from wildscav_engine.view.display import NoDisplayError


@pytest.mark.slow
def test_a_match_is_shown_step_by_step_in_one_recording(monkeypatch: pytest.MonkeyPatch) -> None:
    opened: list[Any] = []

    def open_recording() -> rr.RecordingStream:
        recording = rr.RecordingStream(live.APPLICATION)
        opened.append(recording.memory_recording())
        return recording

    monkeypatch.setattr(live, "open_recording", open_recording)
    env = SingleEnv("battle", **options("battle", sensors={}, render_mode="rerun"))
    assert not opened  # nothing opens before it is needed
    env.action_space.seed(0)
    for seed in range(2):
        env.reset(seed=seed)
        for _ in range(3):
            env.step(env.action_space.sample())
    assert env.render() is None
    assert len(opened) == 1
    assert len(opened[0].drain_as_bytes()) > 10_000
    env.close()
    env.close()


@pytest.mark.parametrize("mode", ["human", "rerun"])
def test_without_a_display_there_is_one_clear_error_at_once(
    monkeypatch: pytest.MonkeyPatch, mode: Literal["human", "rerun"]
) -> None:
    for name in ("DISPLAY", "WAYLAND_DISPLAY", "SDL_VIDEODRIVER"):
        monkeypatch.delenv(name, raising=False)
    env = SingleEnv("navigation", **options("navigation", sensors={}, render_mode=mode))
    with pytest.raises(NoDisplayError, match=rf'"{mode}" opens a window.*use render_mode="rgb_array"'):
        env.reset(seed=0)
