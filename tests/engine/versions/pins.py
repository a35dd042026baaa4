"""Pins: the digests that each version stands for, in pins.json.

``python -m tests.engine.versions.pins``, in the root of the repository, adds those of new versions and of new
cases. What is pinned already is never changed: another digest needs another version.
"""

import json
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import NamedTuple

from tests.engine.versions.cases import map_digests, match_digests, record_bytes

from wildscav_engine import SIMULATION_VERSION
from wildscav_engine.maps import GENERATOR_VERSION
from wildscav_engine.record.format import LAYOUT

FILE = Path(__file__).with_name("pins.json")
COMMAND = "python -m tests.engine.versions.pins"

Pins = dict[str, dict[str, dict[str, str]]]  # by the name of the version, its number, and the case


class Version(NamedTuple):
    """A version number that says whether something is still the same."""

    name: str
    number: int
    where: str  # it is raised
    digests: Callable[[Mapping[str, str]], dict[str, str]]  # by case, given what is pinned for the number


class PinError(Exception):
    """What is pinned for a version has moved; the message says what to do."""


HOME = "engine/wildscav_engine"
_ALL = (
    Version("generator", GENERATOR_VERSION, f"GENERATOR_VERSION in {HOME}/maps/game_map.py", map_digests),
    Version("simulation", SIMULATION_VERSION, f"SIMULATION_VERSION in {HOME}/version.py", match_digests),
    Version("record", LAYOUT.version, f"the version in LAYOUT in {HOME}/record/format.py", record_bytes),
)
VERSIONS = {version.name: version for version in _ALL}


def read_pins(file: Path = FILE) -> Pins:
    """Return all pins; none where there is no file yet."""
    pins: Pins = json.loads(file.read_text()) if file.exists() else {}
    return pins


def pinned_for(version: Version, pins: Pins) -> dict[str, str]:
    """Return the pins of a version, by case; none of a new one."""
    return pins.get(version.name, {}).get(str(version.number), {})


def check(version: Version, pins: Pins) -> dict[str, str]:
    """Return the digests of a version, having checked that none of those that are pinned has moved.

    Raises:
        PinError: One has, or a case is gone.
    """
    pinned = pinned_for(version, pins)
    digests = version.digests(pinned)
    moved = [case for case, digest in pinned.items() if digests.get(case) != digest]
    if moved:
        raise PinError(
            f"{version.name} version {version.number} no longer gives what is pinned for it: "
            f"{', '.join(moved)}. If that is intended, raise {version.where}, then run: {COMMAND}"
        )
    return digests


def add_new(versions: Iterable[Version], file: Path = FILE) -> list[str]:
    """Pin what has no pin yet; return what was pinned, a line for each version.

    Raises:
        PinError: Something that is pinned has moved. Nothing is written then.
    """
    pins, added = read_pins(file), []
    for version in versions:
        digests = check(version, pins)
        new = sorted(set(digests) - set(pinned_for(version, pins)))
        if new:
            pins.setdefault(version.name, {})[str(version.number)] = digests
            added.append(f"{version.name} version {version.number}: pinned {', '.join(new)}")
    if added:
        file.write_text(json.dumps(pins, indent=2) + "\n")
    return added


def main() -> None:
    """Pin what is new, and say what it was."""
    try:
        added = add_new(VERSIONS.values())
    except PinError as error:
        raise SystemExit(str(error)) from None
    print("\n".join(added) or "Every version is pinned already.")  # noqa: T201 - a command's answer


if __name__ == "__main__":
    main()
