"""The reference of the Python packages: the names on each page, which mkdocstrings describes."""

from collections.abc import Callable
from functools import partial
from typing import NamedTuple


class Reference(NamedTuple):
    """A page of the reference."""

    title: str
    opening: str
    # The described names by module; no names stand for all public names of the module.
    names: dict[str, str]


PAGES = {
    "environments": Reference(
        "Environments",
        "The public names of `wildscav_engine.envs`. The guide is [environments](../environments.md).",
        {
            "wildscav_engine.envs": "SingleEnv VectorArena parallel_env aec_env ParallelArena BatchedArena "
            "StableVector EnvConfig EnvOptions EpisodeOptions FlatObservations FlatActions describe "
            "League Learners PolicyOpponent StatefulPolicy Sampler SeatController",
            "wildscav_training.opponents": "submission SubmissionOpponent",
        },
    ),
    "sensors": Reference(
        "Sensors",
        "The public names of `wildscav_engine.sensors`. The guide is [sensors](../sensors.md).",
        {"wildscav_engine.sensors": ""},
    ),
    "matches": Reference(
        "Matches and specs",
        "The parts of a match. [The rules](../rules.md) explain the numbers.",
        {
            "wildscav_engine.specs.match_spec": "MatchSpec",
            "wildscav_engine.specs.map_spec": "MapSpec MapConfig Country Placement",
            "wildscav_engine.specs.supply_config": "SupplyConfig SupplyWave HotSpot",
            "wildscav_engine.specs.zone_config": "ZoneConfig ZonePhase",
            "wildscav_engine.specs.rules": "Rules",
            "wildscav_engine.simulation.match": "Match",
            "wildscav_engine.specs.result": "MatchResult",
            "wildscav_engine.tracks": "Track",
        },
    ),
    "maps": Reference(
        "Maps",
        "The public names of `wildscav_engine.maps`. The guide is [maps](../maps.md).",
        {"wildscav_engine.maps": ""},
    ),
    "records": Reference(
        "Records and replays",
        "The public names of `wildscav_engine.record` and `wildscav_engine.view`. "
        "See also [watching](../watching.md).",
        {"wildscav_engine.record": "", "wildscav_engine.view": ""},
    ),
}


def pages() -> dict[str, Callable[[], str]]:
    """Return a function for each page, which writes it, by its path on the website."""
    return {f"reference/{name}.md": partial(_page, one) for name, one in PAGES.items()}


def _page(reference: Reference) -> str:
    described = [
        f"::: {path}"
        for module, names in reference.names.items()
        for path in ([f"{module}.{name}" for name in names.split()] or [module])
    ]
    return "\n\n".join([f"# {reference.title}", reference.opening, *described]) + "\n"
