"""A version stands for what it gives: nothing that is pinned for it ever changes (see CONTRIBUTING.md)."""

from collections.abc import Mapping
from pathlib import Path

import pytest
from tests.engine.versions.pins import (
    COMMAND,
    VERSIONS,
    PinError,
    Version,
    add_new,
    check,
    pinned_for,
    read_pins,
)


@pytest.mark.parametrize("name", VERSIONS)
def test_every_version_gives_what_is_pinned_for_it(name: str) -> None:
    version, pins = VERSIONS[name], read_pins()
    digests = check(version, pins)
    assert digests.keys() == pinned_for(version, pins).keys(), COMMAND


def paint(number: int, **colors: str) -> Version:
    def digests(_: Mapping[str, str]) -> dict[str, str]:
        return dict(colors)

    return Version("paint", number, "PAINT in paint.py", digests)


def test_a_new_version_is_pinned_beside_the_old_ones(tmp_path: Path) -> None:
    file = tmp_path / "pins.json"
    assert add_new([paint(1, wall="red")], file) == ["paint version 1: pinned wall"]
    assert add_new([paint(2, wall="blue")], file) == ["paint version 2: pinned wall"]
    assert read_pins(file) == {"paint": {"1": {"wall": "red"}, "2": {"wall": "blue"}}}


def test_another_digest_of_the_same_version_is_refused_and_it_says_what_to_do(
    tmp_path: Path,
) -> None:
    file = tmp_path / "pins.json"
    add_new([paint(1, wall="red", roof="grey")], file)
    before = file.read_bytes()
    with pytest.raises(PinError) as refused:
        add_new([paint(1, wall="blue", roof="grey")], file)
    assert str(refused.value) == (
        "paint version 1 no longer gives what is pinned for it: wall. "
        f"If that is intended, raise PAINT in paint.py, then run: {COMMAND}"
    )
    assert file.read_bytes() == before


def test_a_case_may_be_added_to_a_version_and_none_taken_away(tmp_path: Path) -> None:
    file = tmp_path / "pins.json"
    add_new([paint(1, wall="red")], file)
    assert add_new([paint(1, wall="red", door="green")], file) == ["paint version 1: pinned door"]
    assert add_new([paint(1, wall="red", door="green")], file) == []
    with pytest.raises(PinError, match="wall"):
        add_new([paint(1, door="green")], file)
