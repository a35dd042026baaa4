"""What a client sends to begin an episode; what is left out has the original's defaults."""

import functools
from collections.abc import Sequence
from typing import Any

import numpy as np

from wildscav_engine.geometry.terrain import ground_at
from wildscav_engine.maps import GameMap, load_map
from wildscav_engine.simulation.match import Match
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_legacy.commander_pb2 import AgentSetup, GameMode, GMCommand, Vector3

MAP = 103  # 100 m × 100 m
SHOOT = {0: {"shoot_gun": True}}


def vector(place: Sequence[float]) -> Vector3:
    x, y, z = place
    return Vector3(x=x, y=y, z=z)


def setup(agent: int = 0, start: Sequence[float] | None = None, **fields: Any) -> AgentSetup:
    place = vector((0, 0, 0) if start is None else start)
    return AgentSetup(id=agent, agent_name=f"agent_{agent}", start_location=place, **fields)


def command(
    mode: GameMode = GameMode.NAVIGATION_MODE,
    agents: Sequence[AgentSetup] = (),
    target: Sequence[float] = (1, 0, 1),
    **fields: Any,
) -> GMCommand:
    setups = list(agents) or [setup()]
    given: dict[str, Any] = {"map_id": MAP, "num_agents": len(setups)} | fields
    return GMCommand(
        game_mode=mode,
        agent_setups=setups,
        target_location=vector(target),
        supply_heatmap_center=Vector3(x=0, y=0, z=0),
        **given,
    )


@functools.cache
def open_way(length: float, direction: float = 0.0, map_id: int = MAP) -> list[float]:
    """A valid location from where a walk in a compass direction meets nothing for so many metres."""
    game_map: GameMap = load_map(map_id)
    across = np.array([np.sin(np.radians(direction)), np.cos(np.radians(direction))])
    for place in from_the_middle(game_map):
        end = (place[0] + across[0] * length, place[2] + across[1] * length)
        if max(map(abs, end)) < game_map.config.size / 2 - 1 and _is_open(game_map, place, direction, length):
            return [round(number, 3) for number in place]
    raise AssertionError("no open way on the map")


def from_the_middle(game_map: GameMap) -> list[list[float]]:
    """The outdoor places of a map, the nearest to its middle first."""
    return sorted(game_map.outdoor.tolist(), key=lambda place: place[0] ** 2 + place[2] ** 2)


def _is_open(game_map: GameMap, place: list[float], direction: float, length: float) -> bool:
    x, y, z = place
    match = Match(MatchSpec(track="navigation", map=game_map.spec, start=(x, y, z), time_limit=60), game_map)
    for _ in range(round(length)):
        match.step([[direction, 10.0, 0, 0, 0, 0, 0, 0]])
    walked = match.state.agents.walked[0, 0]
    return bool(not match.over and abs(walked - round(length)) < 0.01)


@functools.cache
def face_to_face(distance: float = 5.0, map_id: int = MAP) -> tuple[list[float], list[float]]:
    """Two places on nearly level open ground, the second north of the first and in plain sight."""
    game_map = load_map(map_id)
    for place in from_the_middle(game_map):
        ahead = [place[0], place[1], place[2] + distance]
        if max(map(abs, ahead)) > game_map.config.size / 2 - 2:
            continue
        if _is_open(game_map, place, 0.0, distance):
            ahead[1] = float(ground_at(game_map.world, ahead[0], ahead[2]).height)
            if abs(ahead[1] - place[1]) < 0.2:
                return place, ahead
    raise AssertionError("no level way on the map")


def far_target() -> list[float]:
    """A place on the map that nobody in these tests reaches."""
    place: list[float] = load_map(103).outdoor[-1].round(3).tolist()
    return place


def duel(
    first: dict[str, Any] | None = None, second: dict[str, Any] | None = None, **fields: Any
) -> GMCommand:
    """Agent 0 looks at agent 1, who stands 5 m north of it."""
    here, there = face_to_face()
    agents = [setup(0, here, **(first or {})), setup(1, there, **(second or {}))]
    return command(GameMode.SUP_BATTLE_MODE, agents=agents, **{"supply_house_create_percent": 0, **fields})
