"""What was played, as actions of each mode: exact where the mode can say it, else the nearest choice."""

from typing import Any

import numpy as np
import pytest
from gymnasium.vector.utils import batch_space
from tests.engine.envs.common import SMALL

from wildscav_engine.envs.settings.config import EnvConfig
from wildscav_engine.envs.spaces.actions import ActionError, action_mode
from wildscav_engine.envs.spaces.played_actions import played_encoder, played_space
from wildscav_engine.specs.actions import FIELDS, Field

# Walks north-east at 7.5 m/s, turns right by 5° and looks up by 1° in each of five frames, jumps and shoots.
ROW = np.array([[45.0, 7.5, 5.0, -1.0, 1.0, 0.0, 1.0, 0.0]], np.float32)


def config(mode: str, track: str = "battle") -> EnvConfig:
    return EnvConfig(track=track, map=SMALL, action_mode=mode)  # type: ignore[arg-type]


def encoded(mode: str, row: Any = ROW, yaw: float = 0.0, track: str = "battle") -> Any:
    return played_encoder(config(mode, track))(np.asarray(row, np.float32), np.array([yaw]))


def test_the_mode_dict_keeps_what_was_played() -> None:
    action = {name: value[0].item() for name, value in encoded("dict").items()}
    walk_and_view = {"walk_direction": 45.0, "walk_speed": 7.5, "turn": 5.0, "look": -1.0}
    assert action == walk_and_view | {"jump": 1, "pick_up": 0, "shoot": 1, "reload": 0}


@pytest.mark.parametrize(
    ("field", "given", "kept"),
    [
        (Field.WALK_DIRECTION, -90.0, 270.0),
        (Field.WALK_DIRECTION, 730.0, 10.0),
        (Field.WALK_DIRECTION, 360.0, 360.0),
        (Field.TURN, 350.0, -10.0),
        (Field.TURN, -180.0, -180.0),
        (Field.LOOK, 95.0, 90.0),  # the view looks no farther down
    ],
)
def test_angles_outside_the_space_become_the_same_angles_inside(
    field: Field, given: float, kept: float
) -> None:
    row = np.zeros((1, FIELDS), np.float32)
    row[0, field] = given
    action = {name: np.asarray(value[0]) for name, value in encoded("dict", row).items()}
    assert action[field.name.lower()] == kept
    assert played_space(config("dict")).contains(action)


def test_the_mode_box_has_the_same_walk() -> None:
    walk = 0.75 * np.sqrt(0.5)
    assert encoded("box")[0] == pytest.approx([walk, walk, 25 / 45, -0.25, 1.0, -1.0, 1.0, -1.0])


@pytest.mark.parametrize("rules", ["original", "fair"])
def test_the_mode_keys_has_the_keys_that_were_held(rules: str) -> None:
    chosen = EnvConfig(track="battle", map=SMALL, action_mode="keys", rules=rules)  # type: ignore[arg-type]
    space, yaws = batch_space(action_mode(chosen).space, 500), np.linspace(-180.0, 180.0, 500)
    space.seed(0)
    held, rows = space.sample(), np.zeros((500, FIELDS), np.float32)
    action_mode(chosen).decode(held, yaws, rows, (500,))

    found, again = played_encoder(chosen)(rows, yaws), np.zeros_like(rows)
    action_mode(chosen).decode(found, yaws, again, (500,))
    assert again.tobytes() == rows.tobytes()
    for name in ("jump", "pick_up", "shoot", "reload"):
        np.testing.assert_array_equal(found[name], held[name])
    most = 9000 if rules == "original" else 1800  # 36° in a step
    np.testing.assert_array_equal(found["mouse_x"], np.rint(held["mouse_x"]).clip(-most, most))
    for key, other in (("forward", "back"), ("left", "right")):  # both together are neither
        np.testing.assert_array_equal(found[key], held[key] & ~held[other] & 1)


@pytest.mark.parametrize(
    "row",
    [
        [45.0, 10.0, 0.001, 0.0, 0.0, 0.0, 0.0, 0.0],  # a mouse turns a fiftieth of a degree
        [45.0, 7.5, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],  # keys walk at 10 m/s
        [44.0, 10.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],  # and in eight directions
        [0.0, 0.0, 50.0, 0.0, 0.0, 0.0, 0.0, 0.0],  # 250° in a step
    ],
)
def test_what_no_keys_do_is_said(row: list[float]) -> None:
    with pytest.raises(ActionError, match="did not play by keys"):
        encoded("keys", [row])


@pytest.mark.parametrize(
    ("yaw", "walk"),
    [
        (0.0, 2),  # 45° from the view
        (45.0, 1),  # straight ahead
        (90.0, 8),  # 45° to the left
        (690.0, 3),  # 75°, nearer to 90 than to 45
    ],
)
def test_the_mode_multidiscrete_has_the_nearest_choices(yaw: float, walk: int) -> None:
    # 7.5 m/s is as near to 5 as to 10; 25° is nearer to 15 than to 45, and -5° is a choice itself.
    assert encoded("multidiscrete", yaw=yaw)[0].tolist() == [walk, 0, 5, 1, 1, 0, 1, 0]


def test_the_mode_fine_has_the_nearest_of_more_turns_and_who_hardly_walks_stands() -> None:
    # 25° is nearer to 30 than to 17, and -5° to -4 than to -8.
    assert encoded("fine")[0].tolist() == [2, 0, 10 + 8, 6 - 4, 1, 0, 1, 0]
    row = np.zeros((1, FIELDS), np.float32)
    row[0, Field.WALK_SPEED] = 2.0
    assert encoded("multidiscrete", row)[0, 0] == 0


@pytest.mark.parametrize(
    ("direction", "speed", "picks_up", "choice"),
    [(90.0, 9.0, 0.0, 2 * 6 + 2 * 2), (88.0, 8.0, 1.0, 2 * 6 + 2 * 2 + 1), (2.0, 1.0, 1.0, 1)],
)
def test_the_mode_baseline_has_the_nearest_walk(
    direction: float, speed: float, picks_up: float, choice: int
) -> None:
    row = np.zeros((1, FIELDS), np.float32)
    row[0, [Field.WALK_DIRECTION, Field.WALK_SPEED, Field.PICK_UP]] = direction, speed, picks_up
    assert action_mode(config("baseline", "gathering")).describe()["table"][choice][Field.PICK_UP] == picks_up
    assert encoded("baseline", row, track="gathering").tolist() == [choice]


@pytest.mark.parametrize("track", ["navigation", "gathering", "battle"])
@pytest.mark.parametrize("mode", ["dict", "box", "baseline", "multidiscrete", "fine"])
def test_actions_of_a_mode_come_back_from_what_they_played(mode: str, track: str) -> None:
    decoder, encoder = action_mode(config(mode, track)), played_encoder(config(mode, track))
    space = decoder.space
    space.seed(3)
    yaws = np.array([-130.0])
    for _ in range(50):
        action, rows = space.sample(), np.zeros((1, FIELDS), np.float32)
        decoder.decode(action, yaws, rows, ())
        again = np.zeros((1, FIELDS), np.float32)
        back = encoder(rows, yaws)
        one = {name: np.asarray(value[0]) for name, value in back.items()} if mode == "dict" else back[0]
        assert played_space(config(mode, track)).contains(one)
        decoder.decode(one, yaws, again, ())
        if mode == "box":  # decoded anew, a length over 1 is one of 1
            assert again == pytest.approx(rows, abs=1e-3)
        else:
            assert again.tobytes() == rows.tobytes()
