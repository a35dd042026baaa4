"""The reference of the Python packages: which names stand on which page; mkdocstrings describes them."""

from collections.abc import Callable
from functools import partial
from typing import NamedTuple


class Reference(NamedTuple):
    """A page of the reference."""

    title: str
    opening: str
    # Modules, and the names of each that are described; without names, all that the module offers.
    names: dict[str, str]


PAGES = {
    "sdk": Reference(
        "SDK",
        "What an agent imports: `from wildscav import Agent, Action, MatchInfo, Observation, run`. "
        "[The SDK](../sdk.md) has the same as tables.",
        {
            "wildscav": "Agent run Action Observation MatchInfo VisibleAgent SupplyBox SupplyWave Vector",
            "wildscav.errors": "",
        },
    ),
    "policy": Reference(
        "Policies",
        "Trained policies as agents, without the engine: [training](../training.md) tells how to export one.",
        {"wildscav.policy": ""},
    ),
    "environments": Reference(
        "Environments",
        "What `wildscav_engine.envs` offers; [environments](../environments.md) is the guide.",
        {
            "wildscav_engine.envs": "SingleEnv VectorArena parallel_env aec_env ParallelArena BatchedArena "
            "StableVector EnvConfig EnvOptions FlatObservations FlatActions describe"
        },
    ),
    "sensors": Reference(
        "Sensors",
        "What `wildscav_engine.sensors` offers; [sensors](../sensors.md) is the guide.",
        {"wildscav_engine.sensors": ""},
    ),
    "matches": Reference(
        "Matches and specs",
        "What a match is made of. [The rules](../rules.md) say what the numbers mean.",
        {
            "wildscav_engine.specs.match_spec": "MatchSpec",
            "wildscav_engine.specs.map_spec": "MapSpec MapConfig",
            "wildscav_engine.specs.supply_config": "SupplyConfig SupplyWave",
            "wildscav_engine.specs.zone_config": "ZoneConfig ZonePhase",
            "wildscav_engine.specs.rules": "Rules",
            "wildscav_engine.simulation.match": "Match",
            "wildscav_engine.specs.result": "MatchResult",
            "wildscav_engine.tracks": "Track",
        },
    ),
    "maps": Reference(
        "Maps",
        "What `wildscav_engine.maps` offers; [maps](../maps.md) is the guide.",
        {"wildscav_engine.maps": ""},
    ),
    "records": Reference(
        "Records and replays",
        "What `wildscav_engine.record` and `wildscav_engine.view` offer; see also [replays](../replays.md).",
        {"wildscav_engine.record": "", "wildscav_engine.view": ""},
    ),
}


def pages() -> dict[str, Callable[[], str]]:
    """Return what writes each page, by the page's path on the site."""
    return {f"reference/{name}.md": partial(_page, one) for name, one in PAGES.items()}


def _page(reference: Reference) -> str:
    described = [
        f"::: {path}"
        for module, names in reference.names.items()
        for path in ([f"{module}.{name}" for name in names.split()] or [module])
    ]
    return "\n\n".join([f"# {reference.title}", reference.opening, *described]) + "\n"
