"""Depth maps and LIDAR compared with Intel Embree on one core, in turns; pictures; all sensors; two threads.

Embree gets the exported mesh and precomputed rays in float32, while our times include making the rays. With
``--check`` nothing is timed: the images of both are compared, and differences explained.
"""

import os
import time
from functools import partial
from typing import Annotated, NamedTuple

import numpy as np
import typer
from benchmarks.report import Figure, JsonFile, in_turns, publish, ratio
from benchmarks.speed.agreement import check
from benchmarks.speed.embree import Mesh, Rays, Tracer, mesh_of, rays_of
from numpy.typing import NDArray

from wildscav_engine.geometry.world import Kind
from wildscav_engine.maps import generate_map
from wildscav_engine.maps.game_map import GameMap
from wildscav_engine.sensors import SENSORS, ColorCamera, DepthCamera, Lidar, Screen
from wildscav_engine.simulation.match import Match
from wildscav_engine.specs.map_spec import MapConfig
from wildscav_engine.specs.match_spec import MatchSpec

# This much vegetation makes 357 trees and 143 rocks (and 191 bushes) on the map of seed 1.
COUNTRY = MapConfig(size=500, houses=15, storeys=(2, 3), vegetation=0.1905)
MAP_SEED = 1
FAR = 100.0  # m
SIZES = ((10, 10), (38, 22), (64, 36))
OUTDOOR, INDOOR = 200, 56  # poses
PICTURES = ((640, 360), (84, 84))
EVERY = 8  # of how many poses a picture is taken at one
ROUNDS = 20  # over all poses
TIMES_FOR_THREADS = 8  # repetitions of the poses in a batch for threads
SCREENS = ((160, 120), (640, 360))
SENSOR_ROUNDS = 7  # of each sensor
EYES = 1.5  # m above the ground
STEEPEST = 30.0  # degrees up and down
VIEWERS = 8  # agents in a batch of readings
CHECKED = 500  # poses of each kind that are compared


class Poses(NamedTuple):
    """Where images are made from: outdoor poses, then indoor ones."""

    positions: NDArray[np.float64]  # (N, 3) m, of the eyes
    yaws: NDArray[np.float64]  # (N,) degrees
    pitches: NDArray[np.float64]  # (N,) degrees


def draw_poses(game_map: GameMap, outdoor: int, indoor: int, seed: int) -> Poses:
    """Draw standing places of a map, and where to look from there."""
    random = np.random.default_rng(seed)
    places = [
        some[random.integers(len(some), size=count)]
        for some, count in ((game_map.outdoor, outdoor), (game_map.indoor, indoor))
    ]
    return Poses(
        np.concatenate(places) + np.array([0.0, EYES, 0.0]),
        random.uniform(-180.0, 180.0, outdoor + indoor),
        random.uniform(-STEEPEST, STEEPEST, outdoor + indoor),
    )


def race(game_map: GameMap, tracer: Tracer, poses: Poses, size: tuple[int, int]) -> list[Figure]:
    """Measure one size of images: in each round all poses by Embree, by ours one by one, by ours at once."""
    camera, count = DepthCamera(*size, FAR), len(poses.yaws)
    reach = np.full(size[0] * size[1], FAR, np.float32)
    embree = [partial(tracer.distances, *rays_of(*pose, *size), reach) for pose in zip(*poses, strict=True)]
    alone = [
        partial(camera.render, game_map, *(array[pose : pose + 1] for array in poses))
        for pose in range(count)
    ]
    works = [*embree, *alone, partial(camera.render, game_map, *poses)]
    taken = in_turns(works, ROUNDS, before=partial(reach.fill, FAR))  # Embree writes its answers there
    return _figures(f"{size[0]} × {size[1]}", taken[:, :count], taken[:, count:-1], taken[:, -1] / count)


def _figures(
    size: str, embree: NDArray[np.float64], alone: NDArray[np.float64], together: NDArray[np.float64]
) -> list[Figure]:
    """Return medians over the rounds: (rounds, poses) s of a call a pose, (rounds,) s of one for all."""
    places = {"all": slice(None), "outdoor": slice(0, OUTDOOR), "indoor": slice(OUTDOOR, None)}
    figures = []
    for place, part in places.items():
        theirs, ours = embree[:, part].mean(axis=1), alone[:, part].mean(axis=1)
        figures += [
            _microseconds(f"{size}, {place}: embreex", theirs),
            _microseconds(f"{size}, {place}: ours, a call a pose", ours),
            ratio(f"{size}, {place}: times embreex", theirs / ours),
        ]
    theirs = embree.mean(axis=1)
    figures.append(_microseconds(f"{size}, all: ours, one call for all", together))
    figures.append(ratio(f"{size}, all: times embreex, one call for all", theirs / together))
    return figures


def _microseconds(name: str, taken: NDArray[np.float64]) -> Figure:
    """Return the median of the rounds' seconds an image."""
    spread = f"median of {len(taken)} rounds, {taken.min() * 1e6:,.1f} to {taken.max() * 1e6:,.1f}"
    return Figure(name, float(np.median(taken)) * 1e6, "µs", spread)


def lidar_figures(game_map: GameMap, tracer: Tracer, poses: Poses) -> list[Figure]:
    """Measure LIDAR at its defaults as ``race`` measures depth maps: by Embree, and by ours at once."""
    lidar = Lidar()
    rays = [lidar_rays(lidar, *pose) for pose in zip(poses.positions, poses.yaws, strict=True)]
    reaches = np.empty((len(rays), lidar.rays), np.float32)

    def embree() -> None:
        for (origins, ways), reach in zip(rays, reaches, strict=True):
            tracer.distances(origins, ways, reach)

    works = [embree, partial(lidar.render, game_map, *poses)]
    refill = partial(reaches.fill, lidar.range)  # Embree writes its answers there
    theirs, ours = in_turns(works, SENSOR_ROUNDS, before=refill).T / len(rays)
    name = f"lidar, {lidar.channels} × {lidar.azimuths}, all"
    return [
        _microseconds(f"{name}: embreex", theirs),
        _microseconds(f"{name}: ours, one call for all", ours),
        ratio(f"{name}: times embreex", theirs / ours),
    ]


def lidar_rays(lidar: Lidar, position: NDArray[np.float64], yaw: float) -> Rays:
    """Return the rays of a LIDAR as Embree takes them."""
    azimuths = np.radians(yaw + 360.0 * np.arange(lidar.azimuths) / lidar.azimuths)
    rises = np.radians(lidar.elevations)[:, None]
    ways = [
        np.sin(azimuths) * np.cos(rises),
        np.sin(rises) + 0.0 * azimuths,
        np.cos(azimuths) * np.cos(rises),
    ]
    rays = np.stack(ways, axis=-1).reshape(-1, 3).astype(np.float32)
    return np.tile(position.astype(np.float32), (len(rays), 1)), rays


def picture_figures(game_map: GameMap, poses: Poses) -> list[Figure]:
    """Measure pictures, in processor time of the thread: the best of the rounds."""
    some = Poses(*(array[::EVERY].copy() for array in poses))
    figures = []
    for width, height in PICTURES:
        for shadows in (True, False):
            camera = ColorCamera(width=width, height=height, shadows=shadows)
            taken = in_turns([partial(camera.render, game_map, *some)], SENSOR_ROUNDS, time.thread_time)
            rate = len(some.yaws) * width * height / float(taken.min()) / 1e6
            name = f"pictures, {width} × {height}, {'with' if shadows else 'without'} shadows"
            figures.append(Figure(name, rate, "million pixels/s", f"best of {SENSOR_ROUNDS} rounds"))
    return figures


def thread_figures(game_map: GameMap, poses: Poses, cores: set[int]) -> list[Figure]:
    """Measure two threads relative to one, in turns, on large batches, if there are two cores."""
    if len(cores) < 2:
        return []
    os.sched_setaffinity(0, cores)
    figures = []
    many = Poses(*(np.concatenate([array] * TIMES_FOR_THREADS) for array in poses))
    for size in SIZES:
        camera = DepthCamera(*size, FAR)
        render = partial(camera.render, game_map, *many)
        one, two = in_turns([render, partial(render, threads=2)], ROUNDS).T
        name = f"{size[0]} × {size[1]}: two threads, times one, {len(many.yaws):,} images a call"
        figures.append(ratio(name, one / two))
    return figures


def sensor_figures(game_map: GameMap, poses: Poses) -> list[Figure]:
    """Measure every sensor of the registry at its defaults, for one agent and for many."""
    match = Match(MatchSpec(track="gathering", map=game_map.spec, seats=("submission",) * VIEWERS), game_map)
    agents = match.state.agents
    some = np.linspace(0, len(poses.yaws) - 1, VIEWERS).astype(int)
    agents.position[0] = poses.positions[some] - np.array([0.0, EYES, 0.0])
    agents.yaw[0], agents.pitch[0] = poses.yaws[some], poses.pitches[some]
    figures = []
    for name, kind in SENSORS.items():
        sensor = kind()
        shape = " × ".join(map(str, sensor.space.shape))
        works = [
            partial(sensor.read, match, seats)
            for seats in (*([seat] for seat in range(VIEWERS)), range(VIEWERS))
        ]
        taken = in_turns(works, SENSOR_ROUNDS)
        figures += [
            _microseconds(f"sensor {name}, {shape}: one agent a call", taken[:, :-1].mean(axis=1)),
            _microseconds(f"sensor {name}, {shape}: {VIEWERS} agents a call, each", taken[:, -1] / VIEWERS),
        ]
    return figures


def display_figures(game_map: GameMap) -> list[Figure]:
    """Measure what a screen costs more than the camera, in processor time: the best of the rounds."""
    match = Match(MatchSpec(track="battle", map=game_map.spec, seats=("submission",) * VIEWERS), game_map)
    match.state.agents.hit_by_seat[0] = 0  # a red frame, the most that is drawn
    figures = []
    for width, height in SCREENS:
        screen, rounds = Screen(width=width, height=height), 20 * SENSOR_ROUNDS
        pictures = np.zeros((1, VIEWERS, *screen.shape), np.uint8)
        draw = partial(screen.draw_over, match.state, match.seen, "battle", np.arange(VIEWERS), pictures)
        each = float(in_turns([draw], rounds, time.thread_time).min()) / VIEWERS * 1e6
        name = f"screen over camera, {width} × {height}, {VIEWERS} agents a call, each"
        figures.append(Figure(name, each, "µs", f"best of {rounds} rounds"))
    return figures


def describe(game_map: GameMap, mesh: Mesh) -> str:
    """Describe a map by the numbers of its objects."""
    kinds = game_map.world.solid_kind
    counts = {kind: int((kinds == kind).sum()) for kind in (Kind.TRUNK, Kind.ROCK, Kind.BUSH)}
    size = game_map.config.size
    return (
        f"{size} × {size} m, {len(game_map.houses)} houses, {counts[Kind.TRUNK]} trees, {counts[Kind.ROCK]} "
        f"rocks, {counts[Kind.BUSH]} bushes, {len(kinds)} solids, {len(mesh.triangles)} triangles"
    )


CheckOnly = Annotated[bool, typer.Option("--check", help="Compare the images instead of timing them.")]


def main(check_only: CheckOnly = False, json_file: JsonFile = None) -> None:
    """Measure and print."""
    cores = os.sched_getaffinity(0)
    os.sched_setaffinity(0, {min(cores)})
    game_map = generate_map(COUNTRY, MAP_SEED)
    mesh = mesh_of(game_map.world)
    tracer = Tracer(mesh)
    where = describe(game_map, mesh)
    if check_only:
        poses = draw_poses(game_map, CHECKED, CHECKED, seed=1)
        figures = check(game_map, mesh, tracer, poses, SIZES[-1], FAR)
        publish(f"Depth maps against Embree: agreement ({where})", figures, json_file)
        return
    poses = draw_poses(game_map, OUTDOOR, INDOOR, seed=0)
    figures = [figure for size in SIZES for figure in race(game_map, tracer, poses, size)]
    figures += lidar_figures(game_map, tracer, poses)
    figures += picture_figures(game_map, poses)
    figures += sensor_figures(game_map, poses)
    figures += display_figures(game_map)
    figures += thread_figures(game_map, poses, cores)
    publish(f"Images on one core, far {FAR:g} m ({where})", figures, json_file)


if __name__ == "__main__":
    typer.run(main)
