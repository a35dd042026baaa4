"""Rulings on how choices become what is played."""

from typing import Any

import numpy as np
import pytest
from gymnasium.spaces import Box, Dict, Discrete, MultiDiscrete

from wildscav_engine.envs.settings.config import EnvConfig
from wildscav_engine.envs.spaces.actions import MODES, ActionError, action_mode
from wildscav_engine.specs.actions import FIELDS, Field


def decoded(track: str, mode: str, action: Any, yaw: float = 0.0) -> dict[str, float]:
    """Return the fields that are not 0 of what an action becomes."""
    rows = np.zeros((1, FIELDS), np.float32)
    action_mode(EnvConfig(track=track, action_mode=mode)).decode(action, np.array([yaw]), rows, ())
    return {field.name.lower(): round(float(rows[0, field]), 3) for field in Field if rows[0, field]}


@pytest.mark.parametrize(
    ("track", "mode", "action", "walk", "becomes"),
    [
        ("navigation", "baseline", 0, (0, 3), {}),
        ("navigation", "baseline", 7, (270, 6), {}),
        ("gathering", "baseline", 47, (315, 9), {"pick_up": 1}),
        ("navigation", "box", [1, 0, 0, 0, -1], (90, 10), {}),
        ("navigation", "box", [0.3, 0.4, 1, 0, 0.1], (36.87, 5), {"turn": 9, "jump": 1}),
        ("navigation", "box", [1, 1, 0, -1, 0], (45, 10), {"look": -4}),
        ("battle", "box", [0, 0, 0, 0, -1, -1, 0.5, -1], (0, 0), {"shoot": 1}),
        ("navigation", "multidiscrete", [0, 1, 3, 2, 0], (0, 0), {}),
        ("navigation", "multidiscrete", [3, 0, 6, 2, 1], (120, 5), {"turn": 9, "jump": 1}),
        ("navigation", "fine", [0, 1, 11, 6, 0], (0, 0), {"turn": 0.1}),
        ("battle", "fine", [0, 0, 0, 12, 0, 0, 1, 0], (0, 0), {"turn": -24, "look": 3.2, "shoot": 1}),
        (
            "battle",
            "multidiscrete",
            [1, 1, 3, 4, 0, 1, 0, 1],
            (30, 10),
            {"look": 4, "pick_up": 1, "reload": 1},
        ),
    ],
)
def test_an_action_becomes(
    track: str, mode: str, action: Any, walk: tuple[float, float], becomes: dict[str, float]
) -> None:
    walks = zip(("walk_direction", "walk_speed"), walk, strict=True)
    wanted = becomes | {name: value for name, value in walks if value}
    assert decoded(track, mode, np.array(action), yaw=30.0) == wanted


HELD = {"forward": 0, "back": 0, "left": 0, "right": 0, "jump": 0, "mouse_x": 0.0, "mouse_y": 0.0}


@pytest.mark.parametrize(
    ("held", "becomes"),
    [
        ({}, {}),
        ({"forward": 1}, {"walk_direction": 30, "walk_speed": 10}),
        ({"back": 1, "right": 1}, {"walk_direction": 165, "walk_speed": 10}),  # two keys are no faster
        ({"back": 1, "forward": 1, "left": 1}, {"walk_direction": -60, "walk_speed": 10}),
        ({"mouse_x": 500.0, "mouse_y": -25.0}, {"turn": 2, "look": -0.1}),  # 10° and half a degree
        ({"mouse_x": 500.4, "forward": 1}, {"walk_direction": 40, "walk_speed": 10, "turn": 2}),
        ({"mouse_x": -9000.0, "jump": 1}, {"turn": -36, "jump": 1}),
    ],
)
def test_keys_become(held: dict[str, float], becomes: dict[str, float]) -> None:
    assert decoded("navigation", "keys", HELD | held, yaw=30.0) == becomes


def test_a_body_turns_no_farther_than_its_rules_let_it() -> None:
    """By fair rules that is 36° in a step of five frames, and one walks where one looks then."""
    rows = np.zeros((1, FIELDS), np.float32)
    config = EnvConfig(track="navigation", action_mode="keys", rules="fair")  # type: ignore[arg-type]
    action_mode(config).decode(HELD | {"mouse_x": 5000.0, "forward": 1}, np.array([170.0]), rows, ())
    assert rows[0, :4].tolist() == np.float32([-154.0, 10.0, 7.2, 0.0]).tolist()


def test_the_dict_is_the_papers() -> None:
    """Speeds are whole in the space, but any is played, so that what agents did in a record can be, too."""
    action = {"walk_direction": 10.0, "walk_speed": 7.5, "turn": -3.0, "look": 1.0, "jump": 1}
    assert decoded("navigation", "dict", action) == {name: value for name, value in action.items() if value}


STILL = {"walk_direction": 0, "walk_speed": 0, "turn": 0, "look": 0, "jump": 0}
FIELDS_OF = "must be a dictionary of walk_direction, walk_speed, turn, look, jump$"


@pytest.mark.parametrize(
    ("mode", "action", "message"),
    [
        ("dict", {"walk_speed": 1}, f"^actions: a dict of walk_speed, {FIELDS_OF}"),
        ("dict", [0, 0, 0, 0, 0], f"^actions: a list, {FIELDS_OF}"),
        ("dict", STILL | {"walk_speed": 11}, "^walk_speed: 11, must be from 0 to 10$"),
        ("dict", STILL | {"walk_speed": "fast"}, "^walk_speed: 'fast', must be numbers of shape"),
        ("dict", STILL | {"walk_direction": np.nan}, r"^walk_direction: nan, must be in \[0, 360\]$"),
        ("dict", STILL | {"jump": 0.5}, "^jump: 0.5, must be 0 or 1$"),
        ("dict", STILL | {"turn": "1.0"}, "^turn: '1.0', must be numbers of shape"),
        ("dict", STILL | {"turn": [1, 2]}, r"^turn: int64 of shape \(2,\), must be numbers of shape \(\)$"),
        ("box", [0, 0, 0, 0], r"must be numbers of shape \(5,\)"),
        ("box", STILL, r"^actions: \{.*\}, must be numbers of shape \(5,\)"),
        ("box", [0, [0, 0], 0, 0, 0], r"^actions: .*, must be numbers of shape \(5,\)"),
        ("box", [0, 0, 0, 0, 1.5], r"^actions: 1.5, must be in \[-1, 1\]$"),
        ("box", [0, 0, np.nan, 0, 0.0], r"^actions: nan, must be in \[-1, 1\]$"),
        (
            "keys",
            {"forward": 1},
            "^actions: a dict of forward, must be a dictionary of forward, back, l",
        ),
        ("keys", HELD | {"left": 0.5}, "^left: 0.5, must be 0 or 1$"),
        ("keys", HELD | {"mouse_y": 9001.0}, r"^mouse_y: 9001, must be in \[-9000, 9000\]$"),
        ("keys", HELD | {"mouse_x": np.nan}, r"^mouse_x: nan, must be in \[-9000, 9000\]$"),
        ("baseline", 8, "^actions: 8, must be from 0 to 7$"),
        ("baseline", -1, "^actions: -1, must be from 0 to 7$"),
        ("baseline", 0.5, "^actions: 0.5, must be whole numbers$"),
        ("baseline", np.inf, "^actions: inf, must be whole numbers$"),
        (
            "multidiscrete",
            [9, 0, 0, 0, 0],
            r"^actions: \[9, 0, 0, 0, 0\], must be .* \[8, 1, 6, 4, 1\]$",
        ),
        ("multidiscrete", [0, 0, 0, 0, 0.5], "^actions: 0.5, must be whole numbers$"),
    ],
)
def test_bad_actions_are_refused(mode: str, action: Any, message: str) -> None:
    with pytest.raises(ActionError, match=message):
        decoded("navigation", mode, action)


@pytest.mark.parametrize(
    ("mode", "action"), [("baseline", 7.0), ("multidiscrete", [3.0, 0.0, 6.0, 2.0, 1.0])]
)
def test_whole_numbers_may_be_floats(mode: str, action: Any) -> None:
    whole = np.asarray(action).astype(int)
    assert decoded("navigation", mode, np.float32(action)) == decoded("navigation", mode, whole)


def test_numbers_of_a_box_are_decoded_alike_whatever_their_type() -> None:
    chosen = action_mode(EnvConfig(track="battle", action_mode="box"))
    actions = np.random.default_rng(0).uniform(-1, 1, (200, 8)).astype(np.float32)
    found = []
    for given in (actions, actions.astype(np.float64), actions.tolist(), np.asfortranarray(actions)):
        rows = np.zeros((200, FIELDS), np.float32)
        chosen.decode(given, np.zeros(200), rows, (200,))
        found.append(rows.tobytes())
    assert found == [found[0]] * 4


@pytest.mark.parametrize("mode", MODES)
def test_many_actions_are_decoded_as_each_is_alone(mode: str) -> None:
    from gymnasium.vector.utils import batch_space, iterate

    chosen = action_mode(EnvConfig(track="battle", action_mode=mode))
    space = batch_space(chosen.space, 6)
    space.seed(0)
    actions, yaws = space.sample(), np.linspace(-170, 170, 6)
    rows, alone = np.ones((6, FIELDS), np.float32), np.zeros((6, FIELDS), np.float32)
    rows[:] = 0.0
    chosen.decode(actions, yaws, rows, (6,))
    for row, action in enumerate(iterate(space, actions)):
        chosen.decode(action, yaws[row : row + 1], alone[row : row + 1], ())
    assert rows.tobytes() == alone.tobytes()


@pytest.mark.parametrize("mode", MODES)
def test_masks_are_of_the_form_that_spaces_sample_by(mode: str) -> None:
    chosen = action_mode(EnvConfig(track="battle", action_mode=mode))
    space = chosen.space
    space.seed(0)
    for alive in (True, False):
        assert space.contains(space.sample(chosen.mask(alive)))
    if mode == "baseline":
        assert {int(space.sample(chosen.mask(False))) for _ in range(20)} == {0}


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("track", ["navigation", "gathering", "battle"])
def test_the_columns_of_an_action_are_those_of_its_space(track: str, mode: str) -> None:
    chosen = action_mode(EnvConfig(track=track, action_mode=mode))
    columns, space = chosen.columns, chosen.space
    low = np.array([column.low for column in columns])
    high = np.array([column.high for column in columns])
    if isinstance(space, Dict):
        assert [column.name for column in columns] == list(space.spaces)
        for column, field in zip(columns, space.spaces.values(), strict=True):
            least, most = (0, field.n - 1) if isinstance(field, Discrete) else (field.low, field.high)
            assert (column.low, column.high) == (least, most), column
    elif isinstance(space, Box):
        assert (low == space.low).all()
        assert (high == space.high).all()
    else:
        sizes = space.nvec if isinstance(space, MultiDiscrete) else np.array([space.n])
        assert (low == 0).all()
        assert (high == sizes - 1).all()
    assert all(column.meaning for column in columns)
