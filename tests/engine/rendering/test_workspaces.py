"""Workspaces are kept for the next image, and none of it is seen in that image."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
from tests.builders import box, flat_world

from wildscav_engine.rendering.trace import Scene, scene_of
from wildscav_engine.rendering.tracing.workspace import LARGEST_CACHED, Size

LARGE = Size(256, LARGEST_CACHED // 256 + 2, 0.5)
SMALL = Size(4, 4, 0.5)


def scene() -> Scene:
    return scene_of(flat_world(40, [box((-1, 0, 4), (1, 3.0, 5))]))


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
