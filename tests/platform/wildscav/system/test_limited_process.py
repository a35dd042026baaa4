"""Functions in a process with limits: results come back, and what would take too much ends in a line."""

import pytest

from wildscav.errors import UserError
from wildscav.system.limited_process import LimitExceededError, call_limited


def test_a_result_comes_back() -> None:
    assert call_limited("operator:mul", "ab", 3) == "ababab"


@pytest.mark.parametrize(
    ("function", "arguments", "says"),
    [
        ("operator:mul", ("a", 10**10), "it takes more than 224 MiB of memory"),
        ("json:loads", ("[" * 200_000,), "it is nested too deeply"),
    ],
)
def test_too_much_is_said(function: str, arguments: tuple[object, ...], says: str) -> None:
    with pytest.raises(LimitExceededError, match=says):
        call_limited(function, *arguments)


def test_what_never_ends_is_ended() -> None:
    with pytest.raises(LimitExceededError, match="it takes more than 1 s of processor time"):
        call_limited("operator:pow", 3, 10**9, processor_time=1)


@pytest.mark.parametrize(
    ("function", "arguments", "says"),
    [
        ("os:listdir", ("/none",), "^/none: No such file or directory$"),
        ("builtins:int", ("x",), "^ValueError: invalid literal for int\\(\\) with base 10: 'x'$"),
        ("wildscav.baselines:baseline_folder", ("x",), "^there is no baseline 'x'"),
    ],
)
def test_what_a_function_raises_is_a_line(function: str, arguments: tuple[object, ...], says: str) -> None:
    with pytest.raises(UserError, match=says) as caught:
        call_limited(function, *arguments)
    assert not isinstance(caught.value, LimitExceededError)
    assert "\n" not in str(caught.value)
