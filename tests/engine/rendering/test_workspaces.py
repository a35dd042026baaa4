"""Workspaces are kept for the next image, and none of it is seen in that image."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
from tests.builders import box, flat_world, map_from

from wildscav_engine.rendering.cameras import Cameras
from wildscav_engine.rendering.trace import Scene, scene_of
from wildscav_engine.rendering.tracing.workspace import LARGEST_CACHED, Size
from wildscav_engine.sensors import DepthCamera
from wildscav_engine.sensors.optics.image_sensor import NO_DYNAMIC_OBJECTS, ShownMaps

LARGE = Size(256, LARGEST_CACHED // 256 + 2, 0.5)
SMALL = Size(4, 4, 0.5)


def scene(height: float = 3.0) -> Scene:
    return scene_of(flat_world(40, [box((-1, 0, 4), (1, height, 5))]))


def test_a_scene_keeps_the_workspaces_of_small_images() -> None:
    one = scene()
    assert one.workspaces.of(one.arrays, SMALL) is one.workspaces.of(one.arrays, SMALL)
    assert SMALL in one.workspaces.cached


def test_scenes_share_the_arrays_for_images_of_a_size_and_threads_do_not() -> None:
    one, other = scene(), scene()
    first, second = (each.workspaces.of(each.arrays, SMALL).arrays for each in (one, other))
    assert first.image.rays is second.image.rays
    assert first.solids is not second.solids
    with ThreadPoolExecutor(1) as thread:
        elsewhere = thread.submit(lambda: one.workspaces.of(one.arrays, SMALL).arrays).result()
    assert elsewhere.image.rays is not first.image.rays


def test_scenes_of_about_one_size_share_scratch_buffers_that_suffice_for_each() -> None:
    one, other, large = scene(), scene(), scene_of(flat_world(400))
    first, second, third = (each.workspaces.of(each.arrays, SMALL).arrays for each in (one, other, large))
    assert first.scratch.queue is second.scratch.queue
    assert third.scratch.queue is not first.scratch.queue
    assert len(third.scratch.shown) >= len(large.arrays.blocks.lowest)
    assert len(first.scratch.done) > len(one.arrays.solids.obbs)
    assert len(first.scratch.planes) >= np.diff(one.arrays.solids.face_start).max()


def test_small_images_of_two_maps_in_one_call_are_those_of_each_alone() -> None:
    maps = [map_from(flat_world(40, [box((-1, 0, 4), (1, height, 5))])) for height in (1.0, 3.0)]
    camera, eyes = DepthCamera(width=16, height=9), np.tile([0.0, 1.5, 0.0], (3, 1))
    cameras = Cameras(eyes, np.zeros(3), np.zeros(3), np.full(3, -2, np.int32), *camera.lens)
    images = np.empty((3, 9, 16), np.float32)
    order = [maps[0], maps[1], maps[0]]
    nothing, in_first = NO_DYNAMIC_OBJECTS.sets, np.zeros(3, np.int64)
    assert camera.render_matches_into(ShownMaps(order), nothing, in_first, cameras, images)
    alone = [camera.render(one, eyes[:1], [0.0], [0.0])[0] for one in order]
    assert images.tobytes() == np.stack(alone).tobytes()
    assert (images[0] != images[1]).any()


def test_only_the_latest_workspace_of_a_large_image_is_kept() -> None:
    one, other = scene(), scene()
    first = one.workspaces.of(one.arrays, LARGE)
    assert one.workspaces.of(one.arrays, LARGE) is first
    assert LARGE not in one.workspaces.cached
    taller = LARGE._replace(height=LARGE.height + 1)
    assert one.workspaces.of(one.arrays, taller) is not first
    second = other.workspaces.of(other.arrays, LARGE)
    assert second.arrays.solids is other.arrays.solids
    assert one.workspaces.of(one.arrays, LARGE) is not first


def test_large_images_of_two_maps_in_turns_are_those_of_each_alone() -> None:
    maps = [map_from(flat_world(40, [box((-1, 0, 4), (1, height, 5))])) for height in (1.0, 3.0)]
    camera = DepthCamera(width=LARGE.width, height=LARGE.height)
    alone = [camera.render(one, [(0.0, 1.5, 0.0)], [0.0], [0.0]) for one in maps]
    for turn in range(3):
        again = camera.render(maps[turn % 2], [(0.0, 1.5, 0.0)], [0.0], [0.0])
        assert (again == alone[turn % 2]).all()
    assert (np.asarray(alone[0]) != alone[1]).any()
