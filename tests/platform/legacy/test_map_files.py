"""The map files of the client: small, and the same world as the engine's.

The mesh is read back from its file and traced by Embree, with the camera of the original's version 1.0.0: x
negated, 1.5 m above the soles, 60° wide, square pixels, planar depth, rays cut at their length.
"""

import json
import subprocess
from pathlib import Path

import numpy as np
import pytest
import trimesh
from embreex.mesh_construction import TriangleMesh
from embreex.rtcore_scene import EmbreeScene
from numpy.typing import NDArray
from tests.platform.legacy.helpers.original import environment

from wildscav_engine.maps import GameMap, load_map
from wildscav_engine.sensors import DepthCamera
from wildscav_legacy.install import is_written, obj_of, paths_of, write_map

EYE = np.array([0.0, 1.5, 0.0])
WIDTH, HEIGHT, FAR = 64, 36, 200.0
POSES = 100
Numbers = NDArray[np.float64]


class Mesh:
    """The mesh of a map's file, in Embree."""

    def __init__(self, game_map: GameMap, folder: Path) -> None:
        file = folder / "map.obj"
        file.write_bytes(obj_of(game_map))
        mesh = trimesh.load(file, force="mesh")
        self._scene = EmbreeScene()
        vertices, triangles = mesh.vertices.astype(np.float32), mesh.faces.astype(np.int32)
        self._kept = TriangleMesh(self._scene, vertices, triangles)

    def distances(self, starts: Numbers, ways: Numbers, reach: Numbers) -> Numbers:
        """Return (n,) m to what rays meet, their reach if nothing; all in the engine's frame."""
        mirrored = [np.float32(rays * [-1.0, 1.0, 1.0]) for rays in (starts, ways)]
        met = self._scene.run(*mirrored, query="DISTANCE", dists=np.float32(reach))
        return np.minimum(np.asarray(met, np.float64), reach)


def rays_of(yaw: float, pitch: float) -> Numbers:
    """Return (HEIGHT · WIDTH, 3) unit vectors through the middles of pixels, from the top row on."""
    half = np.tan(np.radians(30.0))
    right = ((np.arange(WIDTH) + 0.5) / WIDTH * 2 - 1) * half
    up = (1 - (np.arange(HEIGHT) + 0.5) / HEIGHT * 2) * half * HEIGHT / WIDTH
    across, rise = np.meshgrid(right, up)
    sin_yaw, cos_yaw = np.sin(np.radians(yaw)), np.cos(np.radians(yaw))
    sin_pitch, cos_pitch = np.sin(np.radians(pitch)), np.cos(np.radians(pitch))
    forward = np.array([sin_yaw * cos_pitch, -sin_pitch, cos_yaw * cos_pitch])
    above = np.array([sin_yaw * sin_pitch, cos_pitch, cos_yaw * sin_pitch])
    aside = np.array([cos_yaw, 0.0, -sin_yaw])
    ways = forward + across[..., None] * aside + rise[..., None] * above
    unit: Numbers = (ways / np.linalg.norm(ways, axis=-1, keepdims=True)).reshape(-1, 3)
    return unit


def depth_by_mesh(mesh: Mesh, eye: Numbers, yaw: float, pitch: float) -> Numbers:
    """Return (HEIGHT, WIDTH) m, planar depth as the original's definition has it."""
    ways = rays_of(yaw, pitch)
    distances = mesh.distances(np.tile(eye, (len(ways), 1)), ways, np.full(len(ways), FAR))
    forward = (
        rays_of(yaw, pitch).reshape(HEIGHT, WIDTH, 3)[HEIGHT // 2 - 1 : HEIGHT // 2 + 1].mean(axis=(0, 1))
    )
    along = ways @ (forward / np.linalg.norm(forward))
    depth: Numbers = np.where(distances >= FAR, FAR, distances * along).reshape(HEIGHT, WIDTH)
    return depth


def standing_places(game_map: GameMap, count: int, seed: int) -> Numbers:
    """Return (count, 3) m places of a map, one in four of them indoors."""
    dice = np.random.default_rng(seed)
    indoors, outdoors = count // 4, count - count // 4
    chosen: Numbers = np.concatenate(
        [
            game_map.indoor[dice.integers(len(game_map.indoor), size=indoors)],
            game_map.outdoor[dice.integers(len(game_map.outdoor), size=outdoors)],
        ]
    )
    return chosen


def test_depth_over_the_mesh_is_the_engines(tmp_path: Path) -> None:
    game_map = load_map(103)
    mesh = Mesh(game_map, tmp_path)
    dice = np.random.default_rng(103)
    eyes = standing_places(game_map, POSES, seed=1) + EYE
    yaws, pitches = dice.uniform(-180, 180, POSES), dice.uniform(-30, 30, POSES)
    ours = DepthCamera(WIDTH, HEIGHT, FAR).render(game_map, eyes, yaws, pitches)
    theirs = [depth_by_mesh(mesh, *pose) for pose in zip(eyes, yaws, pitches, strict=True)]
    same = np.abs(ours - np.array(theirs)) <= 0.05
    assert same.mean() >= 0.995


def test_locations_are_those_of_the_map(tmp_path: Path) -> None:
    write_map(103, tmp_path)
    obj, places = paths_of(103, tmp_path)
    assert (obj.name, places.name) == ("103.obj", "103.json")
    told = json.loads(places.read_text())
    game_map = load_map(103)
    assert set(told) == {"indoor", "outdoor"}
    assert np.allclose(told["indoor"], game_map.indoor, atol=1e-3)
    assert np.allclose(told["outdoor"], game_map.outdoor, atol=1e-3)


def test_a_map_that_something_else_made_or_that_is_cut_short_is_missing(tmp_path: Path) -> None:
    assert not is_written(103, tmp_path)
    write_map(103, tmp_path)
    assert is_written(103, tmp_path)
    obj, places = paths_of(103, tmp_path)
    places.unlink()
    assert not is_written(103, tmp_path)
    places.write_text("{}")
    obj.write_text("# Wildscav map 103, generator 1: x west, y up, z north; m\n")
    assert not is_written(103, tmp_path)


@pytest.mark.slow
def test_the_largest_map_is_small_enough_for_the_client_and_it_loads_it(tmp_path: Path) -> None:
    write_map(8, tmp_path)
    obj, _ = paths_of(8, tmp_path)
    assert obj.read_text().count("\nf ") < 300_000  # triangles; the client takes a second or two for so many
    code = "import sys; from inspirai_fps.raycast import RaycastManager; RaycastManager(sys.argv[1])"
    subprocess.run([environment(), "-c", code, obj], check=True)
