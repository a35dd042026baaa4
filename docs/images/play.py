# ruff: noqa: INP001 - a script, not part of a package
"""Make play.jpg, the picture of a match in the browser in docs/playing.md.

python docs/images/play.py

plays the first seconds of a battle. It needs Chromium and Playwright.
"""

import shutil
import subprocess
import sys
import time
from pathlib import Path
from tempfile import TemporaryDirectory

from playwright.sync_api import sync_playwright

PICTURE = Path(__file__).with_name("play.jpg")
SIZE = {"width": 1280, "height": 720}
PATIENCE = 120_000  # ms


def main() -> None:
    """Play, and take the screenshot."""
    with TemporaryDirectory() as records:
        command = [sys.executable, "-m", "wildscav.cli.main", "human", "--no-browser", "--records", records]
        with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as game:
            assert game.stdout is not None  # noqa: S101
            link = next(line for line in game.stdout if line.startswith("play at ")).split()[-1]
            try:
                _play(link)
            finally:
                game.terminate()


def _play(link: str) -> None:
    with sync_playwright() as tools:
        browser = tools.chromium.launch(executable_path=shutil.which("chromium"), args=["--no-sandbox"])
        page = browser.new_page(viewport=SIZE)
        page.goto(link)
        page.click("#go")
        page.wait_for_selector("#game[data-state=playing]", timeout=PATIENCE)
        page.keyboard.down("KeyW")
        time.sleep(3.0)
        page.keyboard.down("ArrowRight")
        time.sleep(1.2)
        page.keyboard.up("ArrowRight")
        time.sleep(2.0)
        page.screenshot(path=PICTURE, type="jpeg", quality=85)
        browser.close()


if __name__ == "__main__":
    main()
