"""The rules' page tells the numbers that the code has."""

import re
from pathlib import Path

import pytest

from wildscav_engine.maps.ground.lakes import DEEPEST_WATER
from wildscav_engine.specs import actions, body
from wildscav_engine.specs.rules import FRAMES_PER_SECOND, Rules

PAGE = Path("docs/rules.md").read_text()
ROWS = re.findall(r"^\| ([^|]+) \| ([\d.]+)[^|]* \| `(\w+)` \|$", PAGE, re.MULTILINE)


@pytest.mark.parametrize(("what", "number", "name"), ROWS)
def test_each_number_is_that_of_the_code(what: str, number: str, name: str) -> None:
    constants = {**vars(body), **vars(actions), **Rules()._asdict()}
    assert float(number) == constants[name], what


def test_each_constant_of_the_body_is_on_the_page() -> None:
    # The tangent and the cosine are those of the slope limit.
    named = {name for name in vars(body) if name.isupper()} - {"TAN_SLOPE_LIMIT", "COS_SLOPE_LIMIT"}
    assert named <= {name for _, _, name in ROWS}


def test_the_height_and_the_time_of_a_jump_follow() -> None:
    height, time = body.JUMP_SPEED**2 / (2 * body.GRAVITY), 2 * body.JUMP_SPEED / body.GRAVITY
    assert f"{height:.2f} m high and takes {time:.2f} s" in PAGE
    assert f"1/{FRAMES_PER_SECOND} s" in PAGE
    assert f"maps are {DEEPEST_WATER} m deep" in PAGE
