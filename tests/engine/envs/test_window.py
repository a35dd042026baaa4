"""Pictures from behind an agent, and the window of ``render_mode="human"``."""

from collections.abc import Iterator
from typing import Any

import gymnasium
import numpy as np
import pygame
import pytest
from tests.engine.envs.common import env_id, options

from wildscav_engine.envs.parallel import ParallelArena
from wildscav_engine.envs.single import SingleEnv


@pytest.fixture(autouse=True)
def display(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """SDL's driver without a screen."""
    monkeypatch.setenv("SDL_VIDEODRIVER", "dummy")
    yield
    pygame.display.quit()


def chosen(**more: Any) -> Any:
    return options("battle", sensors={}, frames_per_action=1, **more)


def shown() -> np.ndarray:
    """What the window shows, as (height, width, 3)."""
    return np.asarray(pygame.surfarray.array3d(pygame.display.get_surface())).swapaxes(0, 1)


@pytest.mark.parametrize("view", ["eyes", "behind", "top"])
def test_the_window_shows_the_picture_of_the_view(view: Any) -> None:
    env = SingleEnv("battle", **chosen(render_mode="human", render_view=view, render_size=(160, 90)))
    still = SingleEnv("battle", **chosen(render_mode="rgb_array", render_view=view, render_size=(160, 90)))
    assert not pygame.display.get_init()  # it opens with the first episode

    for each in (env, still):
        each.action_space.seed(0)
        each.reset(seed=1)
        each.step(each.action_space.sample())

    assert (shown() == still.render()).all()
    assert env.render() is None
    assert pygame.display.get_caption()[0].startswith("Supply battle: 0 of ")
    env.close()
    assert not pygame.display.get_init()
    env.close()


def test_the_window_is_960_by_540_unless_asked_otherwise() -> None:
    env = SingleEnv("battle", **chosen(render_mode="human"))
    env.reset(seed=1)
    assert shown().shape == (540, 960, 3)
    env.close()


def test_several_learners_share_a_window_and_a_vector_shows_its_first_match() -> None:
    settings = chosen(render_mode="human", render_size=(160, 90))
    vector = gymnasium.make_vec(env_id("battle"), 2, vectorization_mode="vector_entry_point", **settings)
    for env in (ParallelArena("battle", agents=2, **settings), vector):
        env.reset(seed=1)
        assert shown().std() > 5.0
        assert env.render() is None
        env.close()


def test_an_environment_plays_on_without_a_window_that_was_closed() -> None:
    env = SingleEnv("battle", **chosen(render_mode="human", render_size=(160, 90)))
    env.reset(seed=1)
    pygame.event.post(pygame.event.Event(pygame.QUIT))
    for _ in range(3):
        env.step(env.action_space.sample())
    assert not pygame.display.get_init()
    env.close()


def test_from_behind_an_agent_sees_itself() -> None:
    pictures = {}
    for view in ("eyes", "behind"):
        env = SingleEnv("battle", **chosen(render_mode="rgb_array", render_view=view, render_size=(200, 100)))
        env.reset(seed=1)
        pictures[view] = np.asarray(env.render())
    assert pictures["behind"].shape == (100, 200, 3)
    assert (pictures["behind"] != pictures["eyes"]).any(axis=2).mean() > 0.2
