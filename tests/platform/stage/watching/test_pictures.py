"""The viewer's pictures are those of the engine's own cameras, from the same places of the same map."""

from collections.abc import Iterator
from io import BytesIO
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image
from tests.browsers import IN_3D, chromium
from tests.recorded_matches import SMALL_MAP

from wildscav_engine.geometry.world import Kind
from wildscav_engine.maps import map_of
from wildscav_engine.maps.game_map import GameMap
from wildscav_engine.record import record_of
from wildscav_engine.sensors import ColorCamera, SegmentationCamera
from wildscav_engine.simulation.match import Match
from wildscav_engine.specs.body import EYE_HEIGHT
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_engine.specs.rules import FRAMES_PER_SECOND
from wildscav_stage.scene.document import Samples, SeatSamples, differences
from wildscav_stage.scene.map_file import map_file
from wildscav_stage.scene.notes import shown_notes
from wildscav_stage.scene.trails import trails_of
from wildscav_stage.watching.match_page import Scene, whole_page

pytestmark = pytest.mark.slow

PATIENCE = 60_000  # ms, with software that draws
APART = 100  # frames between two poses
ACROSS = 75.0  # degrees, of the engine's cameras in a picture of 16 : 9
COARSE = 12  # pixels along a side of those that are compared: fine grain is nobody's business
FAR_OFF = 40  # of 255, in one channel
BEYOND = 15.0  # degrees above the horizon, up to which the viewer shows land beyond the edge of the map
# The mean difference, of 255, and the share of pixels that are far off. Indoors no corner is dark.
OUTDOORS, INDOORS = (2.2, 0.01), (5.6, 0.01)
# Lets the viewer draw as finely as with a graphics card.
FINELY = """
const { getParameter } = WebGL2RenderingContext.prototype;
WebGL2RenderingContext.prototype.getParameter = function (name) {
  return name === 0x9246 || name === this.RENDERER ? "a graphics card" : getParameter.call(this, name);
};
"""
ALONE = ".player-screen > :not(canvas) { display: none !important }"


class Pose(NamedTuple):
    """Where somebody stands and looks."""

    place: NDArray[np.float64]  # m, of the soles
    yaw: int  # degrees
    pitch: int  # degrees, positive looks down


@pytest.fixture(scope="module")
def game_map() -> GameMap:
    return map_of(SMALL_MAP)


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    with chromium(*IN_3D) as browser:
        yield browser


def poses_on(game_map: GameMap) -> list[Pose]:
    """Four poses outdoors and two indoors."""
    outdoor = game_map.outdoor[:: len(game_map.outdoor) // 4][:4]
    indoor = game_map.indoor[:: len(game_map.indoor) // 2][:2]
    turns = ((0, 0), (100, 10), (190, -12), (280, 4), (45, 5), (220, 0))
    return [Pose(place, *turn) for place, turn in zip([*outdoor, *indoor], turns, strict=True)]


def page_of(game_map: GameMap, poses: list[Pose]) -> str:
    """A page of a match on a map in which one agent takes one pose after the other."""
    match = Match(MatchSpec(track="battle", map=SMALL_MAP, seats=("walker", "walker"), time_limit=1.0))
    match.play_out()
    trails = trails_of(record_of(match, ["one", "other"]))
    places = np.rint([100 * pose.place for pose in poses]).astype(int)
    x, height, z = (differences(column) for column in places.T.tolist())
    yaw, pitch = (differences(column) for column in ([pose[part] for pose in poses] for part in (1, 2)))
    still = [0] * (len(poses) - 1)
    samples = SeatSamples(
        x=x, z=z, height=height, yaw=yaw, pitch=pitch, health=[100, *still], supplies=[0, *still]
    )
    frames = differences([APART * number for number in range(len(poses))])
    shown = trails.model_copy(
        update={
            "seats": trails.seats[:1],
            "samples": Samples(frames=frames, seats=[samples]),
            "events": [],
            "boxes": [],
            "zone": [],
            "target": None,
        }
    )
    return whole_page(Scene("poses", map_file(game_map), shown.compressed(), shown_notes([], 1).compressed()))


def seen_by_viewer(browser: Any, address: str) -> Image.Image:
    """What the canvas of a page shows."""
    options = {"viewport": {"width": 680, "height": 900}, "reduced_motion": "reduce", "bypass_csp": True}
    with browser.new_context(**options) as context:
        page = context.new_page()
        page.add_init_script(FINELY)
        page.goto(address)
        page.locator(".player-canvas[data-picture=whole]").wait_for(timeout=PATIENCE)
        page.add_style_tag(content=ALONE)
        return Image.open(BytesIO(page.locator(".player-canvas").screenshot())).convert("RGB")


class View(NamedTuple):
    """What the engine's cameras see from a pose."""

    picture: Image.Image
    is_map: NDArray[np.bool_]  # of each coarse pixel, whether it is of the map or of the sky well above it


def seen_by_engine(game_map: GameMap, pose: Pose, size: tuple[int, int]) -> View:
    """What the engine's cameras see from a pose, in a picture of a size as large as the viewer's."""
    width, height = size
    up = np.tan(np.radians(ACROSS / 2)) * 9 / 16
    across = float(np.degrees(2 * np.arctan(up * width / height)))
    eye = [pose.place + np.array([0.0, EYE_HEIGHT, 0.0])], [pose.yaw], [pose.pitch]
    picture = ColorCamera(width=width, height=height, field_of_view=across).render(game_map, *eye)[0]
    coarse = {"width": width // COARSE, "height": height // COARSE}
    kinds = SegmentationCamera(**coarse, field_of_view=across).render(game_map, *eye)[0]
    rows = 1 - (2 * np.arange(len(kinds)) + 1) / len(kinds)
    is_sky = np.degrees(np.arctan(up * rows))[:, None] - pose.pitch > BEYOND
    return View(Image.fromarray(picture), (kinds != Kind.NOTHING) | is_sky)


def difference(mine: Image.Image, view: View) -> tuple[float, float]:
    """Of what is compared: the mean difference of two pictures, and the share of pixels far off."""
    size = view.is_map.shape[::-1]
    coarse = (each.resize(size, Image.Resampling.BOX) for each in (mine, view.picture))
    first, second = (np.asarray(each, float)[view.is_map] for each in coarse)
    apart = np.abs(first - second)
    return float(apart.mean()), float((apart.max(axis=1) > FAR_OFF).mean())


def test_the_viewer_shows_what_the_engines_cameras_see(
    browser: Any, game_map: GameMap, tmp_path: Path
) -> None:
    file, poses = tmp_path / "poses.html", poses_on(game_map)
    file.write_text(page_of(game_map, poses))
    for number, pose in enumerate(poses):
        seconds = number * APART / FRAMES_PER_SECOND
        mine = seen_by_viewer(browser, f"{file.as_uri()}#t={seconds}&view=eyes&seat=0")
        view = seen_by_engine(game_map, pose, mine.size)
        mean, far_off = difference(mine, view)
        most = OUTDOORS if number < 4 else INDOORS
        assert (mean < most[0], far_off < most[1]) == (True, True), (number, mean, far_off)
