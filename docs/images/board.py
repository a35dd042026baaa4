# ruff: noqa: INP001 - a script, not part of a package
"""Make board.png, the picture of a board in the project's README.

    wildscav season demo --port 8000
    python docs/images/board.py http://127.0.0.1:8000/boards/battle

takes a screenshot of a season that is served. It needs Chromium and Playwright.
"""

import shutil
import sys
from pathlib import Path

from playwright.sync_api import sync_playwright

PICTURE = Path(__file__).with_name("board.png")
SIZE = {"width": 1100, "height": 830}


def main(address: str) -> None:
    """Take the screenshot."""
    with sync_playwright() as tools:
        browser = tools.chromium.launch(executable_path=shutil.which("chromium"), args=["--no-sandbox"])
        page = browser.new_page(viewport=SIZE)
        page.goto(address)
        page.screenshot(path=PICTURE)
        browser.close()


if __name__ == "__main__":
    main(sys.argv[1])
