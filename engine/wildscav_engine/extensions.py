"""What can be added by name: tracks, sensors, robots and more, ours and those of other packages.

Ours are listed here (those of higher layers where they belong). Another package adds one by an entry point in
the group of its kind, such as::

    [project.entry-points."wildscav.sensors"]
    sonar = "my_package.sonar:Sonar"

Whatever asks for a thing by its name imports it then, so that a name costs nothing until it is used.
"""

import importlib
import re
import sys
from collections.abc import Callable, Iterator, Mapping
from functools import cache
from importlib.metadata import EntryPoint, distributions, entry_points
from pathlib import Path
from typing import Any, Generic, NamedTuple, TypeVar

Extension = TypeVar("Extension")
Maker = Callable[[str, Any], Any]

OWN_PACKAGE = "wildscav"
PREFIX = "wildscav."  # of the names of all groups
NAMES = re.compile(r"[a-z][a-z0-9_-]{0,39}")
NAMES_RULE = "must be a lower-case letter and up to 39 more letters, digits, - and _"

# In the order in which people read them.
BUILT_IN: Mapping[str, Mapping[str, str]] = {
    "wildscav.tracks": {
        "navigation": "wildscav_engine.tracks.navigation:Navigation",
        "gathering": "wildscav_engine.tracks.gathering:Gathering",
        "capture": "wildscav_engine.tracks.capture:Capture",
        "battle": "wildscav_engine.tracks.battle:Battle",
        "royale": "wildscav_engine.tracks.royale:Royale",
    },
    "wildscav.sensors": {
        "depth": "wildscav_engine.sensors.depth:DepthCamera",
        "lidar": "wildscav_engine.sensors.lidar:Lidar",
        "camera": "wildscav_engine.sensors.camera:ColorCamera",
        "segmentation": "wildscav_engine.sensors.segmentation:SegmentationCamera",
        "normals": "wildscav_engine.sensors.normals:NormalCamera",
        "visible_agents": "wildscav_engine.sensors.visible_agents:VisibleAgents",
        "teammates": "wildscav_engine.sensors.teammates:Teammates",
        "nearby_supplies": "wildscav_engine.sensors.nearby_supplies:NearbySupplies",
        "compass": "wildscav_engine.sensors.compass:Compass",
        "zone": "wildscav_engine.sensors.safe_zone:SafeZone",
    },
    "wildscav.robots": {
        "walker": "wildscav_engine.simulation.robots.walker:WALKERS",
        "gatherer": "wildscav_engine.simulation.robots.gatherer:GATHERERS",
        "fighter": "wildscav_engine.simulation.robots.fighter:FIGHTERS",
        "seeker": "wildscav_engine.simulation.robots.seeker:SEEKERS",
    },
    "wildscav.metrics": {},
}
# What makes a thing out of what an entry point names; ValueError says that it is not what it must be.
MAKERS: Mapping[str, str] = {
    "wildscav.tracks": "wildscav_engine.simulation.track:make_track",
    "wildscav.sensors": "wildscav_engine.sensors.base:check_sensor",
    "wildscav.robots": "wildscav_engine.simulation.robots.base:check_robots",
    "wildscav.metrics": "wildscav_engine.simulation.track:make_metric",
}


class ExtensionError(Exception):
    """A package adds something that cannot be used; the message names the package and says why."""


class Origin(NamedTuple):
    """The package that something comes from."""

    package: str
    version: str

    def __str__(self) -> str:
        """Return it as people read it."""
        return f"{self.package} {self.version}".strip()


class Addition(NamedTuple):
    """Something that another package adds."""

    group: str
    name: str
    origin: Origin
    problem: str = ""  # why it cannot be used, if it cannot


class Registry(Mapping[str, Extension], Generic[Extension]):
    """The things of one kind by their names: ours in their order, then those of other packages by name."""

    def __init__(
        self, group: str, built_in: Mapping[str, str] | None = None, maker: Maker | None = None
    ) -> None:
        """Look things up in a group.

        Args:
            group: The name of the group of entry points.
            built_in: Ours, each as ``module:object``; by default those that are listed in this file.
            maker: Makes a thing of its name and what its entry point names; by default this file's.
        """
        self.group = group
        self._built_in = BUILT_IN.get(group, {}) if built_in is None else built_in
        self._maker = maker
        self._made: dict[str, Extension] = {}

    @property
    def built_in(self) -> tuple[str, ...]:
        """The names of ours."""
        return tuple(self._built_in)

    def __getitem__(self, name: str) -> Extension:
        """Return a thing.

        Raises:
            KeyError: Nothing has that name.
            ExtensionError: It cannot be imported, or is not what it must be.
        """
        if name not in self._made:
            if name in self._built_in:
                self._made[name] = self._make(name, _object(self._built_in[name]))
            else:
                self._made[name] = self._load(name, self._added[name])
        return self._made[name]

    def __iter__(self) -> Iterator[str]:
        yield from self._built_in
        yield from sorted(self._added)

    def __len__(self) -> int:
        return len(self._built_in) + len(self._added)

    def __contains__(self, name: object) -> bool:
        return name in self._built_in or name in self._added

    def origin(self, name: str) -> Origin | None:
        """Return the package that adds a thing, None for one of ours."""
        return None if name in self._built_in else _origin(self._added[name])

    @property
    def _added(self) -> Mapping[str, EntryPoint]:
        """The entry points of other packages.

        Raises:
            ExtensionError: One has a name that it may not have.
        """
        return _added(self.group, self.built_in)

    def _load(self, name: str, entry: EntryPoint) -> Extension:
        try:
            return self._make(name, entry.load())
        except Exception as error:
            raise ExtensionError(_complaint(entry, error)) from error

    def _make(self, name: str, found: Any) -> Extension:
        maker = self._maker or _maker(self.group)
        made: Extension = maker(name, found)
        return made

    def additions(self) -> Iterator[Addition]:
        """Yield what other packages add, with what is wrong with it; nothing is raised."""
        for entry in _entries(self.group):
            problem = ""
            try:
                _check_name(entry, self.built_in)
                _check_alone(entry)
                self._load(entry.name, entry)
            except ExtensionError as error:
                problem = str(error)
            yield Addition(self.group, entry.name, _origin(entry), problem)


def names(group: str) -> tuple[str, ...]:
    """Return the names in a group of this file's; only ours, if another package's cannot be used."""
    try:
        return tuple(Registry(group))
    except ExtensionError:
        return tuple(BUILT_IN[group])


def added_sources(group: str) -> tuple[Path, ...]:
    """Return the files of what other packages add to a group, without importing anything of them.

    What cannot be found is left out here; whoever uses it is told.
    """
    files = (_file_of(entry.module) for entry in _entries(group))
    return tuple(file for file in files if file is not None)


def other_groups(known: set[str]) -> Iterator[Addition]:
    """Yield what other packages add to groups that nobody reads.

    Args:
        known: The groups that there are.
    """
    groups = {entry.group for package in distributions() for entry in package.entry_points}
    for group in sorted(groups - known):
        problem = f"there is no group {group}; the groups are {', '.join(sorted(known))}"
        if group.startswith(PREFIX):
            yield from (Addition(group, entry.name, _origin(entry), problem) for entry in _entries(group))


def loaded(group: str) -> Iterator[Addition]:
    """Yield what other packages add to a group without a registry, each tried by importing it."""
    for entry in _entries(group):
        problem = ""
        try:
            entry.load()
        except Exception as error:  # noqa: BLE001 - whatever another's package raises
            problem = _complaint(entry, error)
        yield Addition(group, entry.name, _origin(entry), problem)


def _file_of(module: str) -> Path | None:
    """Return the file of a module as an import would find it; ``find_spec`` would import its packages."""
    names, path = module.split("."), None
    for count in range(1, len(names) + 1):
        name = ".".join(names[:count])
        specs = (finder.find_spec(name, path) for finder in sys.meta_path)
        spec = next((spec for spec in specs if spec is not None), None)
        if spec is None:
            return None
        path = spec.submodule_search_locations
    return Path(spec.origin) if spec is not None and spec.has_location and spec.origin else None


def _object(place: str) -> Any:
    module, attribute = place.split(":")
    return getattr(importlib.import_module(module), attribute)


@cache
def _maker(group: str) -> Maker:
    maker: Maker = _object(MAKERS[group]) if group in MAKERS else lambda _, found: found
    return maker


@cache
def _entries(group: str) -> tuple[EntryPoint, ...]:
    """Return the entry points of other packages in a group."""
    return tuple(entry for entry in entry_points(group=group) if _origin(entry).package != OWN_PACKAGE)


def _origin(entry: EntryPoint) -> Origin:
    if entry.dist is None:
        return Origin(entry.module.partition(".")[0], "")
    return Origin(entry.dist.name, entry.dist.version)


def _complaint(entry: EntryPoint, error: Exception) -> str:
    """Return in one line why something cannot be used."""
    why = str(error) if isinstance(error, ValueError) else f"{type(error).__name__}: {error}"
    return f"{_kind(entry.group)} {entry.name!r} of the package {_origin(entry)} cannot be used: {why}"


def _kind(group: str) -> str:
    """Return the word for one thing of a group."""
    word = group.removeprefix(PREFIX)
    return word.removesuffix("es") if word.endswith("xes") else word.removesuffix("s")


@cache
def _added(group: str, built_in: tuple[str, ...]) -> Mapping[str, EntryPoint]:
    """Return the entry points of other packages.

    Raises:
        ExtensionError: One has the name of one of ours or of another, or a name that is not allowed.
    """
    for entry in _entries(group):
        _check_name(entry, built_in)
        _check_alone(entry)
    return {entry.name: entry for entry in _entries(group)}


def _check_name(entry: EntryPoint, built_in: tuple[str, ...]) -> None:
    kind = _kind(entry.group)
    if entry.name in built_in:
        raise ExtensionError(
            f"the package {_origin(entry)} adds a {kind} {entry.name!r}, but Wildscav has one of that name; "
            "uninstall the package"
        )
    if not NAMES.fullmatch(entry.name):
        raise ExtensionError(
            f"the package {_origin(entry)} adds a {kind} {entry.name!r}, but a name {NAMES_RULE}"
        )


def _check_alone(entry: EntryPoint) -> None:
    for other in _entries(entry.group):
        if other.name == entry.name and other.value != entry.value:
            raise ExtensionError(
                f"the packages {_origin(entry)} and {_origin(other)} both add a {_kind(entry.group)} "
                f"{entry.name!r}; uninstall one of them"
            )
