"""The native viewer opens replays without a display: every view must show its part without complaint."""

import time
from collections.abc import Iterator
from io import BytesIO
from pathlib import Path

import pytest
import rerun
from PIL import Image
from rerun.experimental import View, ViewerClient
from tests.engine.view.conftest import robots_play
from tests.ports import free_ports

from wildscav_engine.view import write_replay

pytestmark = pytest.mark.slow
PATIENCE = 90.0  # s
# Colours that a view must show: an empty one has a few. From its eyes an agent may see only sky.
FEWEST = {"Match": 300, "Following": 100}


@pytest.fixture
def viewer() -> Iterator[ViewerClient]:
    if not list(Path("/usr/share/vulkan/icd.d").glob("*.json")):
        pytest.skip("no Vulkan driver to draw with: install mesa-vulkan-drivers")
    binary = Path(rerun.__path__[0]).parent / "rerun_cli" / "rerun"
    client = ViewerClient.spawn(
        headless=True, port=free_ports(), hide_welcome_screen=True, executable_path=str(binary)
    )
    yield client
    client.quit()


def views_of(viewer: ViewerClient) -> dict[str, View]:
    return {view.name: view for view in viewer.get_state().views}


def missing_colors(viewer: ViewerClient, wanted: dict[str, int]) -> dict[str, int]:
    """The views that show fewer colours than wanted, and how many they show."""
    found = {}
    for name in wanted:
        try:
            screenshot = viewer.take_screenshot(views_of(viewer)[name].view_id)
        except (ConnectionError, KeyError, TimeoutError):  # while the layout comes up, or drawing is slow
            found[name] = 0
            continue
        picture = Image.open(BytesIO(screenshot)).convert("RGB")
        found[name] = len(picture.getcolors(maxcolors=picture.width * picture.height) or [])
    return {name: count for name, count in found.items() if count < wanted[name]}


@pytest.mark.parametrize("track", ["navigation", "royale"])
def test_every_view_of_a_replay_shows_its_part(viewer: ViewerClient, track: str, tmp_path: Path) -> None:
    write_replay(robots_play(track), tmp_path / f"{track}.rrd")

    viewer.open(str(tmp_path / f"{track}.rrd"))
    end = time.monotonic() + PATIENCE
    while "Match" not in views_of(viewer) and time.monotonic() < end:
        time.sleep(0.5)
    viewer.set_time("match_time", duration=4.0, play_state="paused")
    wanted = {name: FEWEST[name.split()[0]] for name in views_of(viewer) if name.split()[0] in FEWEST}
    while missing_colors(viewer, wanted) and time.monotonic() < end:
        time.sleep(0.5)

    assert len(wanted) == len(FEWEST)
    assert missing_colors(viewer, wanted) == {}
    assert {name: view.reports for name, view in views_of(viewer).items() if view.reports} == {}
