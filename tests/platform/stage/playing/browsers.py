"""The pages of people who play, in a browser."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import pytest
from tests.browsers import IN_3D, chromium

PATIENCE = 300.0  # s, on a busy machine


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    """A browser for the tests of a file."""
    with chromium(*IN_3D) as started:
        yield started


@contextmanager
def pages(browser: Any) -> Iterator[Callable[..., Any]]:
    """Yield what opens a page, none of which may report an error."""
    errors: list[str] = []
    opened: list[Any] = []

    def new_page(**options: Any) -> Any:
        page = browser.new_page(**options)  # like another browser: it shares nothing with the others
        page.on("pageerror", lambda error: errors.append(str(error)))
        page.on("console", lambda line: errors.append(line.text) if line.type == "error" else None)
        opened.append(page)
        return page

    try:
        yield new_page
    finally:
        for page in opened:
            page.close()
    assert not errors, "\n".join(errors)


def start(page: Any, link: str) -> None:
    """Start a match on the host's page."""
    page.goto(link)
    page.wait_for_selector("#game[data-state=lobby]")
    page.click("#go")
    wait_for_match(page)


def wait_for_match(page: Any) -> None:
    """Wait until a page shows a match that is played."""
    page.wait_for_selector("#game:is([data-state=playing], [data-state=failed])", timeout=PATIENCE * 1000)
    assert page.get_attribute("#game", "data-state") == "playing", page.inner_text("#panel")
    page.wait_for_selector("#clock:not(:empty)", timeout=PATIENCE * 1000)
