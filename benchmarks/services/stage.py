"""What it takes a browser to show a match in 3D: bytes, time to the first picture, and pictures a second.

    python -m benchmarks.services.stage [--size 500] [--json FILE]

A battle of ten robots is served as ``wildscav watch`` does it, over a line of 10 Mbit/s, and drawn by
software in headless Chromium: a graphics card is many times as fast. Measure on an idle machine.
"""

import socket
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Annotated, Any

import numpy as np
import typer
import uvicorn
from benchmarks.report import Figure, JsonFile, publish
from tests.browsers import IN_3D, chromium

from wildscav_engine.record import write_record
from wildscav_engine.simulation.match import Match
from wildscav_engine.specs.map_spec import MapConfig, MapSpec
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_stage.watching.match_site import match_site

SEATS = (*("fighter",) * 4, *("fighter-hard",) * 3, *("gatherer",) * 3)
LINE = {"offline": False, "latency": 20, "downloadThroughput": 1_250_000, "uploadThroughput": 1_250_000}
WHOLE = ".player-canvas[data-picture=whole]"
SHOWN = ".player-canvas[data-picture]"  # once there is a picture
# The time when all that was drawn so far is there, ms.
SEEN = """() => {
  const context = document.querySelector(".player-canvas").getContext("webgl2");
  context.readPixels(0, 0, 1, 1, context.RGBA, context.UNSIGNED_BYTE, new Uint8Array(4));
  return performance.now();
}"""
SECONDS = 8  # for which pictures are counted
WARM_UP = 6000  # ms until the viewer has found out how much the machine can draw
SIZES = {"desktop": (1280, 900), "640 × 360": (680, 900), "phone": (390, 844)}
DRAWN = """
window.drawn = 0;
const { drawElements } = WebGL2RenderingContext.prototype;
let isDrawn = false;
WebGL2RenderingContext.prototype.drawElements = function (...of) {
  isDrawn = true;
  return drawElements.apply(this, of);
};
const next = () => {
  window.drawn += isDrawn;
  isDrawn = false;
  requestAnimationFrame(next);
};
requestAnimationFrame(next);
"""
COUNTED = "[window.drawn, performance.now()]"


@contextmanager
def served(record: Path) -> Iterator[str]:
    """Serve the page of a record within the block, and yield its address."""
    listening = socket.create_server(("127.0.0.1", 0))
    server = uvicorn.Server(uvicorn.Config(match_site("", [record]), log_level="warning", lifespan="off"))
    serving = threading.Thread(target=server.run, kwargs={"sockets": [listening]})
    serving.start()
    try:
        yield f"http://127.0.0.1:{listening.getsockname()[1]}/"
    finally:
        server.should_exit = True
        serving.join()


def first_visit(browser: Any, address: str) -> tuple[float, dict[str, float]]:
    """Open the page over the slow line; return the s until its first picture, and the kB of each file."""
    with browser.new_context(viewport={"width": 1280, "height": 900}) as context:
        page = context.new_page()
        line = context.new_cdp_session(page)
        line.send("Network.enable")
        line.send("Network.emulateNetworkConditions", LINE)
        names, sizes = {}, {}
        line.on(
            "Network.requestWillBeSent",
            lambda event: names.update({event["requestId"]: event["request"]["url"]}),
        )
        line.on(
            "Network.loadingFinished",
            lambda event: sizes.update({names[event["requestId"]]: event["encodedDataLength"] / 1000}),
        )
        page.goto(address, wait_until="commit")
        page.locator(SHOWN).wait_for(state="attached", timeout=60_000)
        seconds = page.evaluate(SEEN) / 1000
        page.locator(WHOLE).wait_for(state="attached", timeout=60_000)
        page.wait_for_timeout(1000)  # until the browser has told of all files
        return seconds, sizes


def pictures(browser: Any, address: str, size: tuple[int, int], view: str) -> float:
    """Return how many pictures a second a page shows while it plays."""
    with browser.new_context(viewport={"width": size[0], "height": size[1]}) as context:
        page = context.new_page()
        page.add_init_script(DRAWN)
        page.goto(f"{address}#view={view}")
        page.locator(SHOWN).wait_for(state="attached", timeout=60_000)
        page.wait_for_timeout(WARM_UP)
        before = page.evaluate(COUNTED)
        page.wait_for_timeout(1000 * SECONDS)
        count, milliseconds = np.subtract(page.evaluate(COUNTED), before)
        return float(1000.0 * count / milliseconds)


def main(
    size: Annotated[int, typer.Option(help="Side of the map, m.")] = 500, json_file: JsonFile = None
) -> None:
    """Measure, and print the figures."""
    config = MapConfig(size=size, houses=30, vegetation=0.5)
    game_map = MapSpec(config=config, seed=3)
    match = Match(MatchSpec(track="battle", map=game_map, seats=SEATS, time_limit=180.0))
    match.play_out()
    with TemporaryDirectory() as folder:
        record = Path(folder) / "match.wsr"
        write_record(record, match, SEATS)
        with served(record) as address, chromium(*IN_3D) as browser:
            first_visit(browser, address)  # the server plays the record once
            seconds, sizes = first_visit(browser, address)
            figures = [
                *(
                    Figure(name.removeprefix(address).partition("?")[0] or "page", kB, "kB")
                    for name, kB in sizes.items()
                ),
                Figure("in all", sum(sizes.values()), "kB"),
                Figure("first picture", seconds, "s", "at 10 Mbit/s"),
                *(
                    Figure(f"{name}, {view}", pictures(browser, address, pixels, view), "pictures a second")
                    for name, pixels in SIZES.items()
                    for view in ("behind", "above")
                ),
            ]
    publish("A match in the browser", figures, json_file)


if __name__ == "__main__":
    typer.run(main)
