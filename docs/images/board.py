# ruff: noqa: INP001 - a script, not part of a package
"""Make board.png and season.png, the pictures of a season, and the boards of the site's demo season.

    wildscav season demo --port 8000 --matches 18
    python docs/images/board.py http://127.0.0.1:8000

takes them from a season that is served. It needs Chromium and Playwright.
"""

import json
import shutil
import sys
from pathlib import Path

import httpx
from playwright.sync_api import sync_playwright

PICTURES = {"board.png": "/boards/battle", "season.png": "/"}
BOARDS = Path(__file__).parents[1] / "examples" / "demo_season.json"
SIZE = {"width": 1100, "height": 830}


def main(address: str) -> None:
    """Take the boards and the screenshots."""
    boards = httpx.get(f"{address}/api/v1/boards").raise_for_status().json()
    BOARDS.write_text(json.dumps(boards, indent=1) + "\n", "utf-8")
    with sync_playwright() as tools:
        browser = tools.chromium.launch(executable_path=shutil.which("chromium"), args=["--no-sandbox"])
        page = browser.new_page(viewport=SIZE)
        for picture, path in PICTURES.items():
            page.goto(f"{address}{path}")
            page.screenshot(path=Path(__file__).with_name(picture))
        browser.close()


if __name__ == "__main__":
    main(sys.argv[1])
