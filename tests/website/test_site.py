"""The site as readers have it: built without a warning, and shown by a browser that asks nobody else."""

import functools
import os
import subprocess
import sys
import threading
from collections.abc import Iterator
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from urllib.parse import urlsplit

import pytest
from tests.browsers import chromium

ROOT = Path(__file__).parents[2]
SITE = ROOT / "out" / "site"
WRITTEN_LAST = SITE / "search" / "search_index.json"  # by `make docs`

pytestmark = [pytest.mark.slow, pytest.mark.long]


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The site that `make docs` has built, or, if a source was changed since, one that is built here."""
    if is_newest():
        return SITE
    folder = tmp_path_factory.mktemp("site")
    command = [sys.executable, "-m", "mkdocs", "build", "--strict", "--site-dir", str(folder)]
    environment = {**os.environ, "NO_MKDOCS_2_WARNING": "1"}
    done = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert "WARNING" not in done.stderr
    return folder


def is_newest() -> bool:
    """Whether `make docs` has built the site since the last change of any file but those of tests."""
    if not WRITTEN_LAST.exists():
        return False
    command = ("git", "ls-files", "-co", "--exclude-standard", "--", ":!tests")
    names = subprocess.check_output(command, cwd=ROOT, text=True).splitlines()
    built = WRITTEN_LAST.stat().st_mtime
    return all((ROOT / name).exists() and (ROOT / name).stat().st_mtime < built for name in names)


class Quiet(SimpleHTTPRequestHandler):
    """Serves files and says nothing."""

    def log_message(self, format: str, *args: object) -> None:  # noqa: A002
        """Say nothing."""


@pytest.fixture(scope="module")
def address(site: Path) -> Iterator[str]:
    with ThreadingHTTPServer(("127.0.0.1", 0), functools.partial(Quiet, directory=str(site))) as server:
        thread = threading.Thread(target=server.serve_forever)
        thread.start()
        yield f"http://127.0.0.1:{server.server_address[1]}"
        server.shutdown()
        thread.join()


def test_no_page_names_a_script_or_style_of_another_host(site: Path) -> None:
    pages = list(site.rglob("*.html"))
    assert len(pages) > 30
    for page in pages:
        text = page.read_text("utf-8")
        for loads in ('src="http', 'rel="stylesheet" href="http', 'src="//', "fonts.googleapis"):
            assert loads not in text, (page, loads)


def test_a_browser_shows_every_page_on_a_phone_and_asks_nobody_else(site: Path, address: str) -> None:
    with chromium() as browser:
        page = browser.new_page(viewport={"width": 390, "height": 800})
        asked: set[str] = set()
        errors: list[str] = []
        page.on("request", lambda request: asked.add(urlsplit(request.url).netloc))
        page.on("pageerror", lambda error: errors.append(str(error)))
        for path in sorted(site.rglob("*.html")):
            name = path.relative_to(site).as_posix()
            assert page.goto(f"{address}/{name}").status == 200
            assert page.locator("h1").count() == 1, name
            wider = page.evaluate("document.documentElement.scrollWidth > window.innerWidth")
            assert not wider, f"{name} is wider than a phone"
            assert page.evaluate("[...document.images].every(one => one.naturalWidth > 0)"), name
        page.wait_for_load_state("networkidle")
        assert errors == []
        assert asked == {urlsplit(address).netloc}


def test_the_search_finds_a_command(address: str) -> None:
    with chromium() as browser:
        page = browser.new_page(viewport={"width": 1400, "height": 900})
        page.goto(f"{address}/index.html?q=replay-agent")
        page.wait_for_selector(".md-search-result__link", state="attached")
        links = page.eval_on_selector_all(".md-search-result__link", "links => links.map(link => link.href)")
        assert any("reference/commands.html" in link for link in links)
