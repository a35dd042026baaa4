# ruff: noqa: INP001 - a script, not part of a package
"""Make match.png, the picture of a match in the README: a battle of robots in Rerun's own viewer.

    python docs/images/match.py

needs ``pip install 'wildscav[view]'`` and a graphics card, or a software renderer such as that of
``apt-get install mesa-vulkan-drivers``.
"""

import time
from io import BytesIO
from pathlib import Path
from tempfile import TemporaryDirectory

import rerun
from PIL import Image
from rerun.experimental import ViewerClient

from wildscav_engine.record import record_of
from wildscav_engine.simulation.match import Match
from wildscav_engine.specs.map_spec import MapConfig, MapSpec
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_engine.view import write_replay

MAP = MapConfig(
    size=100,
    relief=1.6,
    ruggedness=1.0,
    water=0.1,
    houses=6,
    density="high",
    storeys=(1, 3),
    vegetation=0.5,
)
SPEC = MatchSpec(
    track="battle",
    map=MapSpec(config=MAP, seed=12),
    seats=("fighter",) * 6,
    time_limit=60.0,
    seed=5,
)
NAMES = tuple(f"fighter {seat + 1}" for seat in range(6))
FOLLOWED, MOMENT = 1, 6.4  # seat; s
TITLE_BAR = 37  # pixels at the top, where the viewer names the renderer
SIZE = (1280, 720)


def picture(replay: Path) -> Image.Image:
    """Open a replay without a display, go to the moment and return a screenshot of the viewer."""
    binary = Path(rerun.__path__[0]).parent / "rerun_cli" / "rerun"
    with ViewerClient.spawn(headless=True, hide_welcome_screen=True, executable_path=str(binary)) as viewer:
        viewer.open(str(replay))
        time.sleep(5)
        viewer.set_time("match_time", duration=MOMENT, play_state="paused")
        time.sleep(5)
        return Image.open(BytesIO(viewer.take_screenshot())).convert("RGB")


def main() -> None:
    """Play the match, render its replay, and save the screenshot beside this file."""
    match = Match(SPEC)
    match.play_out()
    with TemporaryDirectory() as folder:
        replay = Path(folder) / "match.rrd"
        write_replay(record_of(match, NAMES), replay, follow=FOLLOWED)
        shown = picture(replay)
    shown = shown.crop((0, TITLE_BAR, shown.width, shown.height))
    shown.resize(SIZE, Image.Resampling.LANCZOS).save(Path(__file__).with_suffix(".png"), optimize=True)


if __name__ == "__main__":
    main()
