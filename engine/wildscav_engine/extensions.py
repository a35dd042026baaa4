"""Extensions found by name: tracks, sensors, robots and more, built in or from other packages.

The built-in ones are listed here, except those of higher layers, which their own modules list. Another
package adds an extension by an entry point in the group of its kind, such as::

    [project.entry-points."wildscav.sensors"]
    sonar = "my_package.sonar:Sonar"

An extension is imported when it is first requested by name, so unused extensions cost nothing.
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
PREFIX = "wildscav."  # with which the names of all groups begin
NAMES = re.compile(r"[a-z][a-z0-9_-]{0,39}")
NAMES_RULE = "must be a lower-case letter and up to 39 more letters, digits, - and _"

# In the order in which they are shown.
BUILT_IN: Mapping[str, Mapping[str, str]] = {
    "wildscav.tracks": {
        "navigation": "wildscav_engine.tracks.navigation:Navigation",
        "gathering": "wildscav_engine.tracks.gathering:Gathering",
        "capture": "wildscav_engine.tracks.capture:Capture",
        "battle": "wildscav_engine.tracks.battle:Battle",
        "royale": "wildscav_engine.tracks.royale:Royale",
    },
    "wildscav.sensors": {
        "depth": "wildscav_engine.sensors.optics.depth:DepthCamera",
        "lidar": "wildscav_engine.sensors.optics.lidar:Lidar",
        "camera": "wildscav_engine.sensors.optics.camera:ColorCamera",
        "screen": "wildscav_engine.sensors.screen.screen:Screen",
        "segmentation": "wildscav_engine.sensors.optics.segmentation:SegmentationCamera",
        "normals": "wildscav_engine.sensors.optics.normals:NormalCamera",
        "visible_agents": "wildscav_engine.sensors.state.agents:VisibleAgents",
        "teammates": "wildscav_engine.sensors.state.agents:Teammates",
        "nearby_supplies": "wildscav_engine.sensors.state.supplies:NearbySupplies",
        "compass": "wildscav_engine.sensors.state.places:Compass",
        "zone": "wildscav_engine.sensors.state.safe_zone:SafeZone",
        "hot_spot": "wildscav_engine.sensors.state.places:HotSpotSensor",
        "sights": "wildscav_engine.sensors.state.sights:Sights",
        "to_hot_spot": "wildscav_engine.sensors.state.places:ToHotSpot",
        "to_supplies": "wildscav_engine.sensors.state.supplies:ToSupplies",
        "to_waves": "wildscav_engine.sensors.state.places:ToWaves",
    },
    "wildscav.robots": {
        "walker": "wildscav_engine.simulation.robots.walker:WALKERS",
        "gatherer": "wildscav_engine.simulation.robots.gatherer:GATHERERS",
        "fighter": "wildscav_engine.simulation.robots.fighter:FIGHTERS",
        "seeker": "wildscav_engine.simulation.robots.seeker:SEEKERS",
        "hunter-squad": "wildscav_engine.simulation.robots.hunter_squad:HUNTER_SQUADS",
    },
    "wildscav.metrics": {},
}
# Functions that convert the object of an entry point to an extension; they raise ValueError if it is invalid.
MAKERS: Mapping[str, str] = {
    "wildscav.tracks": "wildscav_engine.simulation.track:make_track",
    "wildscav.sensors": "wildscav_engine.sensors.base:check_sensor",
    "wildscav.robots": "wildscav_engine.simulation.robots.base:check_robots",
    "wildscav.metrics": "wildscav_engine.simulation.track:make_metric",
}


class ExtensionError(Exception):
    """A package's extension cannot be used; the message names the package and the reason."""


class Origin(NamedTuple):
    """The package that provides an extension."""

    package: str
    version: str

    def __str__(self) -> str:
        """Return the package and its version for people."""
        return f"{self.package} {self.version}".strip()


class Addition(NamedTuple):
    """An extension that another package adds."""

    group: str
    name: str
    origin: Origin
    problem: str = ""  # why it cannot be used; empty if it can


class Registry(Mapping[str, Extension], Generic[Extension]):
    """The extensions of one kind by name: built-in ones in order, then those of other packages by name."""

    def __init__(
        self, group: str, built_in: Mapping[str, str] | None = None, maker: Maker | None = None
    ) -> None:
        """Create the registry of a group.

        Args:
            group: The name of the group of entry points.
            built_in: The built-in extensions, each as ``module:object``; by default those in ``BUILT_IN``.
            maker: Creates an extension from its name and the object of its entry point; by default the one
                in ``MAKERS``.
        """
        self.group = group
        self._built_in = BUILT_IN.get(group, {}) if built_in is None else built_in
        self._maker = maker
        self._made: dict[str, Extension] = {}

    @property
    def built_in(self) -> tuple[str, ...]:
        """The names of the built-in extensions."""
        return tuple(self._built_in)

    def __getitem__(self, name: str) -> Extension:
        """Return an extension."""
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
        """Return the package that adds an extension; None if it is built in."""
        return None if name in self._built_in else _origin(self._added[name])

    @property
    def _added(self) -> Mapping[str, EntryPoint]:
        """The entry points of other packages by name."""
        return _added(self.group, self.built_in)

    def _load(self, name: str, entry: EntryPoint) -> Extension:
        try:
            return self._make(name, entry.load())
        except Exception as error:
            raise ExtensionError(_problem(entry, error)) from error

    def _make(self, name: str, found: Any) -> Extension:
        maker = self._maker or _maker(self.group)
        made: Extension = maker(name, found)
        return made

    def additions(self) -> Iterator[Addition]:
        """Yield the extensions that other packages add, with their problems; no error is raised."""
        for entry in _entries(self.group):
            problem = ""
            try:
                _check_name(entry, self.built_in)
                _check_unique(entry)
                self._load(entry.name, entry)
            except ExtensionError as error:
                problem = str(error)
            yield Addition(self.group, entry.name, _origin(entry), problem)


def names(group: str) -> tuple[str, ...]:
    """Return the names in a group of ``BUILT_IN``; only the built-in ones if an added name is invalid."""
    try:
        return tuple(Registry(group))
    except ExtensionError:
        return tuple(BUILT_IN[group])


def sources_of(group: str) -> tuple[Path, ...]:
    """Return the source files of the extensions in a group, built-in ones first, without importing them.

    Missing modules are skipped; the error is raised when the extension is used.
    """
    built_in = (path.split(":")[0] for path in BUILT_IN.get(group, {}).values())
    files = (_file_of(module) for module in (*built_in, *(entry.module for entry in _entries(group))))
    return tuple(file for file in files if file is not None)


def other_groups(known: set[str]) -> Iterator[Addition]:
    """Yield the entry points of other packages in groups with our prefix that nobody knows."""
    groups = {entry.group for package in distributions() for entry in package.entry_points}
    for group in sorted(groups - known):
        problem = f"there is no group {group}; the groups are {', '.join(sorted(known))}"
        if group.startswith(PREFIX):
            yield from (Addition(group, entry.name, _origin(entry), problem) for entry in _entries(group))


def loaded(group: str) -> Iterator[Addition]:
    """Yield the extensions of other packages in a group without a registry, after trying to import each."""
    for entry in _entries(group):
        problem = ""
        try:
            entry.load()
        except Exception as error:  # noqa: BLE001 - another package may raise anything
            problem = _problem(entry, error)
        yield Addition(group, entry.name, _origin(entry), problem)


def _file_of(module: str) -> Path | None:
    """Return the file that an import of a module would load; ``find_spec`` would import its packages."""
    names, path = module.split("."), None
    for count in range(1, len(names) + 1):
        name = ".".join(names[:count])
        specs = (finder.find_spec(name, path) for finder in sys.meta_path)
        spec = next((spec for spec in specs if spec is not None), None)
        if spec is None:
            return None
        path = spec.submodule_search_locations
    return Path(spec.origin) if spec is not None and spec.has_location and spec.origin else None


def _object(path: str) -> Any:
    module, attribute = path.split(":")
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


def _problem(entry: EntryPoint, error: Exception) -> str:
    """Return in one line why an extension cannot be used."""
    why = str(error) if isinstance(error, ValueError) else f"{type(error).__name__}: {error}"
    return f"{_kind(entry.group)} {entry.name!r} of the package {_origin(entry)} cannot be used: {why}"


def _kind(group: str) -> str:
    """Return the word for one extension of a group."""
    word = group.removeprefix(PREFIX)
    return word.removesuffix("es") if word.endswith("xes") else word.removesuffix("s")


@cache
def _added(group: str, built_in: tuple[str, ...]) -> Mapping[str, EntryPoint]:
    """Return the entry points of other packages by name; ExtensionError if a name is taken or not allowed."""
    for entry in _entries(group):
        _check_name(entry, built_in)
        _check_unique(entry)
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


def _check_unique(entry: EntryPoint) -> None:
    for other in _entries(entry.group):
        if other.name == entry.name and other.value != entry.value:
            raise ExtensionError(
                f"the packages {_origin(entry)} and {_origin(other)} both add a {_kind(entry.group)} "
                f"{entry.name!r}; uninstall one of them"
            )
