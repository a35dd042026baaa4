"""Keys of the SDK: the law of the action mode, in the constants and for a mouse that is ahead of its body."""

import numpy as np
import pytest

from wildscav import Action
from wildscav.policy import keys as told
from wildscav.policy.keys import Keys, Mouse, most_counts
from wildscav_engine.envs.spaces import keys as played
from wildscav_engine.specs import actions, rules


def test_the_sdk_has_the_numbers_of_the_engine() -> None:
    assert told.COUNTS_PER_DEGREE == played.COUNTS_PER_DEGREE
    assert told.MOST_COUNTS == played.MOST_COUNTS
    assert told.FASTEST == actions.MAX_WALK_SPEED
    assert (told.FRAMES_PER_SECOND, told.AT_ONCE) == (rules.FRAMES_PER_SECOND, rules.AT_ONCE)


@pytest.mark.parametrize(
    ("keys", "action"),
    [
        (Keys(), Action()),
        (Keys(forward=np.bool_(True)), Action(walk_direction=10.0, walk_speed=10.0)),  # type: ignore[arg-type]
        (Keys(mouse_x=250.0, shoot=True), Action(turn=1.0, shoot=True)),  # 5° in five frames
        (Keys(mouse_y=-9_999.0), Action(look=-7.2)),  # 36° at most
    ],
)
def test_keys_become_the_action_of_a_step(keys: Keys, action: Action) -> None:
    most = most_counts(360.0, frames=5)  # by fair rules
    assert keys.action_with(10.0, most, frames=5) == action


def test_a_body_follows_its_mouse() -> None:
    mouse = Mouse()
    mouse.move(60.0)
    assert [mouse.take(360.0, frames=5) for _ in range(3)] == [1800, 1200, 0]
