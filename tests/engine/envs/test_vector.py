"""Vector environments are single ones, row for row and byte for byte, however many there are."""

import copy
import functools
import pickle
import threading
from collections.abc import Callable
from itertools import product
from typing import Any, ClassVar

import gymnasium
import numpy as np
import pytest
from gymnasium.spaces import Box
from gymnasium.vector import AutoresetMode, SyncVectorEnv
from numpy.typing import NDArray
from tests.engine.envs.common import FEW_BOXES, HOT_SPOT, SMALL, batch_of, digest, env_id, options, play_alike

from wildscav_engine.envs.batched import BatchedArena
from wildscav_engine.envs.single import SingleEnv
from wildscav_engine.envs.vector import VectorArena
from wildscav_engine.maps.game_map import GameMap
from wildscav_engine.rendering.cameras import Cameras
from wildscav_engine.rendering.hits import allocate_hits
from wildscav_engine.rendering.images import trace
from wildscav_engine.rendering.tracing.solids import Solids
from wildscav_engine.sensors import SENSORS, ColorCamera, Lidar, SegmentationCamera, parse_sensors
from wildscav_engine.sensors.base import Column, Sensor, StateSensor, sensor
from wildscav_engine.sensors.optics.dynamic_objects import dynamic_objects_of
from wildscav_engine.sensors.optics.pinhole import PinholeCamera
from wildscav_engine.simulation.match_view import MatchView
from wildscav_engine.simulation.state import State
from wildscav_engine.simulation.systems.visibility import Seen

SMALL_SENSORS = {"depth": {"width": 4, "height": 3}, "visible_agents": {}, "hot_spot": {}}
ENVS = 3


def chosen(track: str, **more: Any) -> dict[str, Any]:
    supplies = {} if track in ("navigation", "capture") else {"supplies": FEW_BOXES | HOT_SPOT}
    more |= {"sensors": SMALL_SENSORS, "action_mode": "multidiscrete", "time_limit": 0.8}
    return options(track, **supplies, **more)


EVERY_MODE = product(("navigation", "royale"), AutoresetMode, (1, 2))
OTHER_TRACKS = product(("gathering", "capture", "battle"), (AutoresetMode.NEXT_STEP,), (2,))


@pytest.mark.parametrize(("track", "mode", "threads"), [*EVERY_MODE, *OTHER_TRACKS])
def test_rows_are_single_environments_in_every_autoreset_mode(
    track: str, mode: AutoresetMode, threads: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("wildscav_engine.simulation.batch.LEAST_AGENTS", 1)
    monkeypatch.setattr("wildscav_engine.sensors.optics.image_sensor.MIN_THREAD_TIME", 1)
    ours = gymnasium.make_vec(
        env_id(track),
        num_envs=ENVS,
        vectorization_mode="vector_entry_point",
        autoreset_mode=mode,
        **chosen(track, threads=threads),
    )
    singles = [lambda: gymnasium.make(env_id(track), **chosen(track))] * ENVS
    play_alike(ours, SyncVectorEnv(singles, autoreset_mode=mode))


TINY: dict[str, Any] = {"width": 8, "height": 6}


@sensor
class Gaze(PinholeCamera):
    """A camera from another package, which reads one match at a time: how far away things are."""

    name: ClassVar[str] = "gaze"
    title: ClassVar[str] = "distance, m"
    dtype: ClassVar[type[np.generic]] = np.float32

    @property
    def space(self) -> Box:
        return Box(np.float32(0.0), np.float32(np.inf), self.shape, np.float32)

    def moving_in(self, match: MatchView) -> Solids:
        return dynamic_objects_of(match)

    def render_into(
        self, game_map: GameMap, moving: Solids, cameras: Cameras, images: NDArray[np.float32]
    ) -> bool:
        hits = allocate_hits(*images.shape)
        is_finite = trace(game_map.scene, moving, cameras, hits)
        images[:] = hits.distance
        return is_finite


@pytest.mark.parametrize(
    ("kind", "chosen", "method"),
    [
        (ColorCamera, TINY, "render_matches_into"),
        (SegmentationCamera, TINY, "render_matches_into"),
        (SegmentationCamera, {"width": 300, "height": 220}, "render_matches_into"),
        (Lidar, {"channels": 2, "azimuths": 9, "moving": True}, "render_matches_into"),
        (Gaze, TINY, "read"),
    ],
)
def test_threads_that_share_images_of_what_moves_change_no_bit(
    kind: type[Sensor], chosen: dict[str, Any], method: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("wildscav_engine.sensors.optics.image_sensor.MIN_THREAD_TIME", 1)
    monkeypatch.setitem(SENSORS._made, Gaze.name, Gaze)
    monkeypatch.setattr(SENSORS, "_built_in", {**SENSORS._built_in, Gaze.name: "its:Gaze"})
    names: set[str] = set()

    def told(threads: int) -> list[Any]:
        sensors = {kind.name: chosen, "depth": {"width": 4, "height": 3}}
        env = VectorArena(
            "battle", 6, **options("battle", sensors=sensors, action_mode="box", threads=threads)
        )
        found: list[Any] = [env.reset(seed=2)[0]]
        env.action_space.seed(1)
        found += [env.step(env.action_space.sample())[0] for _ in range(5)]
        return [digest(observation) for observation in found]

    read, main, helper_reads = getattr(kind, method), threading.current_thread(), threading.Event()

    def noted(*given: Any) -> Any:
        thread = threading.current_thread()
        names.add(thread.name)
        if thread is not main:
            helper_reads.set()
        elif shared:
            # The main thread leaves something to the others, however busy they are.
            assert helper_reads.wait(300)
        return read(*given)

    monkeypatch.setattr(kind, method, noted)
    shared = False
    alone = told(1)
    assert names == {main.name}
    shared = True
    assert told(3) == alone
    assert len(names) > 1


@pytest.mark.parametrize(
    ("name", "chosen"),
    [
        ("camera", {}),
        ("screen", {}),
        ("segmentation", {}),
        ("segmentation", {"label": "instance"}),
        ("segmentation", {"width": 300, "height": 220}),
        ("normals", {}),
        ("normals", {"moving": True}),
        ("depth", {}),
        ("depth", {"moving": True}),
        ("depth", {"moving": True, "width": 300, "height": 220}),
        ("lidar", {"azimuths": 40}),
        ("lidar", {"azimuths": 40, "moving": True}),
        ("lidar", {"azimuths": 40, "lowest": -90, "highest": 90, "moving": True}),
    ],
)
def test_images_of_many_matches_show_each_learner_what_it_sees_in_its_own(
    name: str, chosen: dict[str, Any]
) -> None:
    sensors = {name: ({} if name == "lidar" else {"width": 24, "height": 16}) | chosen}
    arena = BatchedArena("battle", 3, **options("battle", sensors=sensors, action_mode="box", agents=2))
    sensor, images = parse_sensors(sensors)[name], arena.reset(seed=4)[name]
    for _ in range(3):
        views = [arena.arena.view(match) for match in range(3)]
        assert np.stack([sensor.read(view, [0, 1]) for view in views]).tobytes() == images.tobytes()
        images = arena.step(arena.action_space.sample())[0][name]


@sensor
class Watchers(StateSensor):
    """A sensor from another package that asks what others see: how many see each seat."""

    name: ClassVar[str] = "watchers"
    title: ClassVar[str] = "how many see the agent"
    scalars: ClassVar[tuple[Column, ...]] = (Column("watchers", "", 0, 999, "how many see the agent"),)

    def read_batch(self, state: State, seen: Seen, seats: NDArray[np.int64]) -> NDArray[np.float32]:
        return np.array([[[(match == seat).sum()] for seat in seats] for match in seen.agents], np.float32)


def test_a_sensor_may_ask_what_other_seats_see(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(SENSORS._made, Watchers.name, Watchers)
    monkeypatch.setattr(SENSORS, "_built_in", {**SENSORS._built_in, Watchers.name: "its:Watchers"})
    env = VectorArena("battle", 3, **options("battle", sensors={Watchers.name: {}}, action_mode="box"))
    env.reset(seed=1)
    env.action_space.seed(1)
    counted = 0.0
    for _ in range(20):
        observation: Any = env.step(env.action_space.sample())[0]
        matches = [Watchers().read(env.arena.view(match), [0])[0] for match in range(3)]
        assert observation[Watchers.name].tobytes() == np.stack(matches).tobytes()
        counted += observation[Watchers.name].sum()
    assert counted > 0


@pytest.mark.parametrize("flat", [False, True])
@pytest.mark.parametrize("threads", [1, 2])
def test_observations_stay_what_they_were(flat: bool, threads: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("wildscav_engine.sensors.optics.image_sensor.MIN_THREAD_TIME", 1)
    sensors = {"depth": {"width": 4, "height": 3}, "camera": {"width": 8, "height": 6}}
    more = {"sensors": sensors, "action_mode": "box", "threads": threads, "flat": flat}
    env = VectorArena("battle", 3, **options("battle", **more))
    kept = [env.reset(seed=3)[0]]
    env.action_space.seed(1)
    told = [digest(kept[0])]
    for _ in range(5):
        kept.append(env.step(env.action_space.sample())[0])
        told.append(digest(kept[-1]))
    assert [digest(observation) for observation in kept] == told
    assert len({repr(one) for one in told}) == 6


def unpickled(env: Any) -> Any:
    return pickle.loads(pickle.dumps(env))  # noqa: S301


@pytest.mark.parametrize("copied", [copy.deepcopy, unpickled])
@pytest.mark.parametrize("made", [functools.partial(VectorArena, num_envs=3), SingleEnv])
def test_a_copy_plays_on_as_the_original(copied: Callable[[Any], Any], made: Callable[..., Any]) -> None:
    sensors = {"depth": {"width": 4, "height": 3}, "camera": {"width": 8, "height": 6}}
    env = made("battle", **options("battle", sensors=sensors, action_mode="box", threads=2))
    env.reset(seed=3)
    env.action_space.seed(1)
    actions = [env.action_space.sample() for _ in range(6)]
    for action in actions[:3]:
        env.step(action)
    other = copied(env)
    for action in actions[3:]:
        assert digest(other.step(action)) == digest(env.step(action))


def test_maps_differ_between_matches_and_episodes() -> None:
    env = VectorArena("navigation", 4, map=SMALL.config, random_maps=3, sensors=SMALL_SENSORS, time_limit=0.2)
    env.reset(seed=0)
    env.action_space.seed(0)
    seen = {tuple(spec.map.seed for spec in batch_of(env).specs)}
    for _ in range(12):
        observation, *_ = env.step(env.action_space.sample())
        seen.add(tuple(spec.map.seed for spec in batch_of(env).specs))
        assert env.observation_space.contains(observation)
    assert len(seen) > 2
    assert len({seed for seeds in seen for seed in seeds}) == 3
