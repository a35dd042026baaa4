"""When a trained policy walks itself, and when its agent's skills do: a baseline, with a real LIDAR."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from tests.builders import box, flat_world, make_match, place
from tests.platform.wildscav.skills.observations import enemy, match_info, seen

from wildscav import Action, Observation, SupplyBox
from wildscav.baselines import baseline_folder
from wildscav.policy.errors import PolicyError
from wildscav.skills.gathering import Gathering
from wildscav.skills.surroundings import Rings
from wildscav.skills.trained_fighting import FightingPolicyAgent, thinned
from wildscav.skills.trained_gathering import GatheringPolicyAgent
from wildscav_engine.sensors import Lidar

RINGS = Rings(range=100.0, lowest=-55.0, highest=45.0)
POLICYS = {"channels": 2, "azimuths": 24, "range": 100.0, "lowest": -15.0, "highest": 15.0, "moving": False}
MANIFESTS = {**POLICYS, "channels": 31, "azimuths": 96, "lowest": RINGS.lowest, "highest": RINGS.highest}
BOX = SupplyBox(id=3, position=(14.0, 0.0, -9.0), quantity=10)
WALL = flat_world(80, [box((-6, 0, 5), (3, 3, 6))])


class Fighter(FightingPolicyAgent):
    """The baseline."""

    folder = baseline_folder("learned-commando")
    rings = RINGS


class Policy(GatheringPolicyAgent):
    """The baseline's policy, which walks itself everywhere."""

    folder = baseline_folder("learned-commando")


def scanned(options: dict[str, float], yaw: float = 0.0) -> np.ndarray:
    match = make_match(world=WALL)
    place(match, 0, (0, 0, 0), yaw, 0.0)
    return Lidar(**options).read(match, [0])[0]


@pytest.fixture
def sight() -> Callable[..., Observation]:
    """What the agent sees beside a wall: a box, and perhaps more."""
    shapes = Policy().policy.environment.observer.shapes
    names = ("nearby_supplies", "sights", "to_hot_spot", "to_supplies")

    def made(hot_spot: float = 0.0, **changes: object) -> Observation:
        tensors = {name: np.zeros(shapes[name], np.float32) for name in names}
        tensors["to_hot_spot"][0] = hot_spot
        return seen(supply_boxes=(BOX,), tensors={**tensors, "lidar": scanned(MANIFESTS)}, **changes)

    return made


def act_of(kind: type[GatheringPolicyAgent], observation: Observation) -> Action:
    """What an agent does first."""
    agent = kind()
    agent.reset(match_info(time_limit=180.0))
    if kind is Policy:
        observation = replace(observation, tensors={**observation.tensors, "lidar": scanned(POLICYS)})
    return agent.act(observation)


def test_alone_it_walks_as_gathering_says_and_turns_as_its_policy_does(
    sight: Callable[..., Observation],
) -> None:
    gathering = Gathering(match_info(time_limit=180.0), rings=RINGS)
    gathering.look(sight())
    walk = gathering.walk(sight())
    action, policys = act_of(Fighter, sight()), act_of(Policy, sight())
    assert (action.walk_direction, action.walk_speed, action.jump) == walk
    assert action == replace(
        policys, walk_direction=walk.direction, walk_speed=walk.speed, jump=walk.jump, pick_up=False
    )
    assert action != policys


def test_it_picks_up_what_is_within_reach(sight: Callable[..., Observation]) -> None:
    assert act_of(Fighter, sight(can_pick_up=True)).pick_up


@pytest.mark.parametrize(
    "changes",
    [
        pytest.param({"agents": (enemy((0.0, 0.0, 20.0)),)}, id="an enemy in sight"),
        pytest.param({"hot_spot": 1.0}, id="a hot spot"),
        pytest.param({"alive": False}, id="dead"),
    ],
)
def test_otherwise_all_it_does_is_its_policys(
    sight: Callable[..., Observation], changes: dict[str, object]
) -> None:
    assert act_of(Fighter, sight(**changes)) == act_of(Policy, sight(**changes))


@pytest.mark.parametrize("yaw", [0.0, 77.3, -140.0])
def test_a_lidar_with_more_rings_and_columns_reads_what_the_policys_would(yaw: float) -> None:
    reading = thinned(scanned(MANIFESTS, yaw), RINGS, POLICYS)
    assert len(np.unique(reading)) > 3, "the wall, the ground and the sky"
    assert (reading == scanned(POLICYS, yaw)).all()


@pytest.mark.parametrize("changes", [{"azimuths": 25}, {"lowest": -16.0}, {"highest": 50.0}, {"channels": 3}])
def test_a_lidar_without_the_policys_rays_is_refused(changes: dict[str, float]) -> None:
    with pytest.raises(PolicyError, match=r"\[sensors.lidar\] of submission.toml has 31 rings from -55.0 to"):
        thinned(scanned(MANIFESTS), RINGS, {**POLICYS, **changes})
