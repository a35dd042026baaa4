"""The reference of the Python packages: which names stand on which page; mkdocstrings describes them."""

from collections.abc import Callable
from functools import partial
from typing import NamedTuple


class Reference(NamedTuple):
    """A page of the reference."""

    title: str
    opening: str
    names: tuple[str, ...]  # full names of modules, classes and functions


PAGES = {
    "sdk": Reference(
        "SDK",
        "What an agent imports: `from wildscav import Agent, Action, MatchInfo, Observation, run`. "
        "[The SDK](../sdk.md) has the same as tables.",
        (
            *(f"wildscav.{name}" for name in ("Agent", "run", "Action", "Observation", "MatchInfo")),
            *(f"wildscav.{name}" for name in ("VisibleAgent", "SupplyBox", "SupplyWave", "Vector")),
            "wildscav.errors",
        ),
    ),
    "policy": Reference(
        "Policies",
        "Trained policies as agents, without the engine: [training](../training.md) tells how to export one.",
        ("wildscav.policy",),
    ),
    "environments": Reference(
        "Environments",
        "What `wildscav_engine.envs` offers; [environments](../environments.md) is the guide.",
        (
            *(
                f"wildscav_engine.envs.{name}"
                for name in ("SingleEnv", "VectorArena", "parallel_env", "aec_env")
            ),
            *(f"wildscav_engine.envs.{name}" for name in ("ParallelArena", "BatchedArena", "StableVector")),
            *(f"wildscav_engine.envs.{name}" for name in ("EnvConfig", "EnvOptions", "FlatObservations")),
            *(f"wildscav_engine.envs.{name}" for name in ("FlatActions", "describe")),
        ),
    ),
    "sensors": Reference(
        "Sensors",
        "What `wildscav_engine.sensors` offers; [sensors](../sensors.md) is the guide.",
        ("wildscav_engine.sensors",),
    ),
    "matches": Reference(
        "Matches and specs",
        "What a match is made of. [The rules](../rules.md) say what the numbers mean.",
        (
            *(
                f"wildscav_engine.specs.spec.{name}"
                for name in ("MatchSpec", "MapSpec", "MapConfig", "SupplyConfig")
            ),
            *(f"wildscav_engine.specs.spec.{name}" for name in ("SupplyWave", "ZoneConfig", "ZonePhase")),
            "wildscav_engine.specs.rules.Rules",
            "wildscav_engine.simulation.match.Match",
            "wildscav_engine.specs.result.MatchResult",
            "wildscav_engine.tracks.Track",
        ),
    ),
    "maps": Reference(
        "Maps",
        "What `wildscav_engine.maps` offers; [maps](../maps.md) is the guide.",
        ("wildscav_engine.maps",),
    ),
    "records": Reference(
        "Records and replays",
        "What `wildscav_engine.record` and `wildscav_engine.view` offer; see also [replays](../replays.md).",
        ("wildscav_engine.record", "wildscav_engine.view"),
    ),
}


def pages() -> dict[str, Callable[[], str]]:
    """Return what writes each page, by the page's path on the site."""
    return {f"reference/{name}.md": partial(_page, one) for name, one in PAGES.items()}


def _page(reference: Reference) -> str:
    entries = "\n\n".join(f"::: {name}" for name in reference.names)
    return f"# {reference.title}\n\n{reference.opening}\n\n{entries}\n"
