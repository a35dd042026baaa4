"""What can be added to the engine, by name: tracks, sensors and robots, ours and those of other packages.

Ours are listed here. Another package adds one by an entry point in the group of its kind, such as::

    [project.entry-points."wildscav.sensors"]
    sonar = "my_package.sonar:Sonar"

Whatever asks for a thing by its name imports it then, so that a name costs nothing until it is used.
"""

import importlib
from collections.abc import Callable, Iterator, Mapping
from functools import cache
from importlib.metadata import EntryPoint, entry_points
from typing import Any, Generic, TypeVar

Extension = TypeVar("Extension")

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
}


class ExtensionError(Exception):
    """A package adds something that cannot be used; the message names the package and says why."""


class Registry(Mapping[str, Extension], Generic[Extension]):
    """The things of one kind by their names: ours in their order, then those of other packages by name."""

    def __init__(self, group: str, make: Callable[[Any], Extension] = lambda found: found) -> None:
        """Look things up in a group.

        Args:
            group: The name of the group of entry points.
            make: Makes the thing out of what the entry point names.
        """
        self._group, self._make = group, make
        self._made: dict[str, Extension] = {}

    def __getitem__(self, name: str) -> Extension:
        """Return a thing.

        Raises:
            KeyError: Nothing has that name.
            ExtensionError: It cannot be imported.
        """
        if name not in self._made:
            self._made[name] = self._make(_load(self._group, name))
        return self._made[name]

    def __iter__(self) -> Iterator[str]:
        yield from _built_in(self._group)
        yield from sorted(_added(self._group))

    def __len__(self) -> int:
        return len(_built_in(self._group)) + len(_added(self._group))

    def __contains__(self, name: object) -> bool:
        return name in _built_in(self._group) or name in _added(self._group)


def _built_in(group: str) -> Mapping[str, str]:
    return BUILT_IN.get(group, {})


def _load(group: str, name: str) -> Any:
    if name in _built_in(group):
        module, attribute = _built_in(group)[name].split(":")
        return getattr(importlib.import_module(module), attribute)
    entry = _added(group)[name]
    try:
        return entry.load()
    except Exception as error:
        package = entry.dist.name if entry.dist else entry.module
        raise ExtensionError(
            f"{group} {name!r} of the package {package} cannot be imported: {type(error).__name__}: {error}"
        ) from error


@cache
def _added(group: str) -> Mapping[str, EntryPoint]:
    """Return the entry points of other packages.

    Raises:
        ExtensionError: One has the name of one of ours, or two have the same name.
    """
    found: dict[str, EntryPoint] = {}
    for entry in entry_points(group=group):
        package = entry.dist.name if entry.dist else entry.module
        if entry.name in _built_in(group):
            raise ExtensionError(f"the package {package} adds {group} {entry.name!r}, which Wildscav has")
        if entry.name in found and found[entry.name].value != entry.value:
            raise ExtensionError(f"several packages add {group} {entry.name!r}; one of them is {package}")
        found[entry.name] = entry
    return found
