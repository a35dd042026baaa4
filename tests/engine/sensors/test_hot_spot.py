"""The hot spot as agents are told of it: in a match by hand, and alike in environments of every kind."""

from typing import Any

import numpy as np
import pytest
from tests.builders import make_match, place
from tests.engine.envs.common import OPEN

from wildscav_engine.envs import BatchedArena, SingleEnv, VectorArena, parallel_env
from wildscav_engine.envs.settings.config import EnvConfig
from wildscav_engine.sensors import HotSpotSensor
from wildscav_engine.specs.supply_config import HotSpot, SupplyConfig

# It comes to its places after 0.5, 1.5 and 2.5 s.
SUPPLIES = SupplyConfig(waves=(), hot_spot=HotSpot(start=0.5, interval=1.0, places=3, boxes=2))
STEPS = 30  # of 0.1 s


@pytest.mark.parametrize(
    ("frame", "reading"),
    [
        (0, (0, 0, 0, 0, 1, 3, 4, 5, 2.0)),  # it has not come yet: its first place is told
        (99, (0, 0, 0, 0, 1, 3, 4, 5, 0.02)),
        (100, (1, 3, 4, 5, 1, -6, 8, 10, 5.0)),  # it comes in this frame
        (349, (1, 3, 4, 5, 1, -6, 8, 10, 0.02)),
        (350, (1, -6, 8, 10, 0, 0, 0, 0, 0)),  # it stays at its last place
        (9000, (1, -6, 8, 10, 0, 0, 0, 0, 0)),
    ],
)
def test_it_reads_where_the_hot_spot_is_and_where_and_when_it_comes_next(
    frame: int, reading: tuple[float, ...]
) -> None:
    moving = SupplyConfig(waves=(), hot_spot=HotSpot(places=2, boxes=1))
    match = make_match("battle", supplies=moving)
    matches = match.state.matches
    matches.hot_spots[0] = (100, 4, 3), (350, -5, 7)
    matches.frame[0] = frame
    place(match, 0, (1, 0.5, -1), 30)
    assert HotSpotSensor().read(match, [0])[0] == pytest.approx(reading, abs=1e-5)


@pytest.mark.parametrize("track", ["navigation", "gathering", "battle", "royale"])
def test_all_is_zero_without_a_hot_spot(track: str) -> None:
    assert not HotSpotSensor().read(make_match(track), [0]).any()


@pytest.mark.parametrize(
    ("track", "options", "is_told"),
    [
        ("battle", {"supplies": SUPPLIES}, True),
        ("gathering", {"supplies": SUPPLIES}, True),
        ("royale", {"map": OPEN.config.model_copy(update={"supplies": SUPPLIES})}, True),
        (
            "battle",
            {
                "map": OPEN.model_copy(
                    update={"config": OPEN.config.model_copy(update={"supplies": SUPPLIES})}
                )
            },
            True,
        ),
        ("battle", {}, False),
        ("battle", {"supplies": SUPPLIES, "sensors": {}}, False),  # who names sensors gets those alone
        # Nobody gathers there, whatever the map says.
        ("navigation", {"map": OPEN.config.model_copy(update={"supplies": SUPPLIES})}, False),
    ],
)
def test_an_environment_tells_it_where_there_is_one(
    track: str, options: dict[str, Any], is_told: bool
) -> None:
    assert ("hot_spot" in EnvConfig(track=track, **options).read_sensors()) == is_told


def chosen(**more: Any) -> dict[str, Any]:
    sensors = {"hot_spot": {}}
    return {"map": OPEN, "supplies": SUPPLIES, "sensors": sensors, "action_mode": "box", **more}


def test_single_and_vector_environments_read_the_same_bits() -> None:
    vector = VectorArena("gathering", 3, **chosen())
    singles = [SingleEnv("gathering", **chosen()) for _ in range(3)]
    told = [vector.reset(seed=5)[0]["hot_spot"]]
    alone = [[env.reset(seed=5 + number)[0]["hot_spot"]] for number, env in enumerate(singles)]
    actions = np.zeros((3, *singles[0].action_space.shape), np.float32)
    actions[:, 1] = 0.3  # to the north
    for _ in range(STEPS):
        told.append(vector.step(actions)[0]["hot_spot"])
        for row, env in enumerate(singles):
            alone[row].append(env.step(actions[row])[0]["hot_spot"])
    assert np.stack(told).tobytes() == np.stack([np.stack(rows) for rows in alone], axis=1).tobytes()
    places = np.stack(told)[:, 0, 0]
    assert (places[0], places[-1]) == (0, 1)  # it came in the meantime
    assert len({tuple(row) for row in np.stack(told)[0, :, 5:7].tolist()}) == 3  # elsewhere in each match


def test_an_arena_and_environments_of_several_agents_read_the_same_bits() -> None:
    arena = BatchedArena("gathering", 2, agents=2, **chosen())
    several = [parallel_env("gathering", agents=2, **chosen()) for _ in range(2)]
    told = [arena.reset(seed=7)["hot_spot"]]
    alone = [[_of_agents(env.reset(seed=7 + number)[0])] for number, env in enumerate(several)]
    actions = np.zeros((2, 2, *several[0].action_space("agent_0").shape), np.float32)
    actions[:, 1, 0] = 0.4  # the second one to the east
    for _ in range(STEPS):
        told.append(arena.step(actions)[0]["hot_spot"])
        for row, env in enumerate(several):
            step = env.step({agent: actions[row, seat] for seat, agent in enumerate(env.agents)})
            alone[row].append(_of_agents(step[0]))
    assert np.stack(told).tobytes() == np.stack([np.stack(rows) for rows in alone], axis=1).tobytes()


def _of_agents(observations: dict[str, Any]) -> np.ndarray:
    return np.stack([observations[agent]["hot_spot"] for agent in ("agent_0", "agent_1")])
