# ruff: noqa: INP001 - a script, not part of a package
"""Make play.jpg, lobby.webp and spectator.webp, the pictures of docs/playing.md.

python docs/images/play.py

plays the first seconds of two battles. It needs Chromium and Playwright.
"""

import io
import shutil
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from PIL import Image
from playwright.sync_api import Browser, Page, sync_playwright

FOLDER = Path(__file__).parent
SIZE: Any = {"width": 1280, "height": 720}
PATIENCE = 120_000  # ms
OPTIONS = ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
# Pages draw less where software draws, so it does not say that it does; after some slow seconds they know.
AS_HARDWARE = "WebGL2RenderingContext.prototype.getExtension = () => null"
WIDTH = 900  # pixels of a picture of several people


def main() -> None:
    """Play, and take the screenshots."""
    with sync_playwright() as tools:
        browser = tools.chromium.launch(executable_path=shutil.which("chromium"), args=OPTIONS)
        with _game("--seed", "6", "--opponents", ",".join(["gatherer"] * 6)) as (link, _):
            _play_alone(browser, link)
        with _game("--people", "3", "--time-limit", "60") as links:
            _play_together(browser, *links)
        browser.close()


@contextmanager
def _game(*options: str) -> Iterator[list[str]]:
    """Start the command, and yield the links of its people and that of spectators."""
    with TemporaryDirectory() as records:
        command = [sys.executable, "-m", "wildscav.cli.main", "human", "--no-browser", "--records", records]
        with subprocess.Popen([*command, *options], stdout=subprocess.PIPE, text=True) as game:
            assert game.stdout is not None  # noqa: S101
            links = []
            for line in game.stdout:
                links.append(line.split()[-1])
                if line.startswith("spectators watch at "):
                    break
            try:
                yield links
            finally:
                game.terminate()


def _play_alone(browser: Browser, link: str) -> None:
    page = browser.new_page(viewport=SIZE)
    page.add_init_script(AS_HARDWARE)
    page.goto(link)
    _start(page)
    time.sleep(1.0)
    page.keyboard.press("Enter")  # skips the first steps
    page.keyboard.press("KeyF")
    time.sleep(0.5)
    page.screenshot(path=FOLDER / "play.jpg", type="jpeg", quality=85)
    page.close()


def _play_together(browser: Browser, host: str, *others: str) -> None:
    links = (host, others[0], others[-1])
    pages = [browser.new_page(viewport=SIZE) for _ in links]
    for page, link in zip(pages, links, strict=True):
        page.add_init_script(AS_HARDWARE)
        page.goto(link)
    for page, name in zip(pages, ("Ada", "Grace"), strict=False):
        page.fill("#lobby input", name)
        page.press("#lobby input", "Enter")
    pages[0].wait_for_selector("#lobby li >> text=Grace")
    _save(pages[0], "lobby.webp")
    _start(pages[0])
    pages[1].wait_for_selector("#game[data-state=playing]")
    for page in pages[:2]:
        page.keyboard.down("KeyW")
    time.sleep(4.0)
    _save(pages[2], "spectator.webp")


def _start(page: Page) -> None:
    page.click("#go")
    page.wait_for_selector("#game[data-state=playing]", timeout=PATIENCE)


def _save(page: Page, name: str) -> None:
    with Image.open(io.BytesIO(page.screenshot())) as picture:
        picture.thumbnail((WIDTH, WIDTH), Image.Resampling.LANCZOS)
        picture.save(FOLDER / name, quality=82, method=6)


if __name__ == "__main__":
    main()
