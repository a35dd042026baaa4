"""Templates: how values are written on pages. Everything is escaped by default."""

import threading
from collections import OrderedDict
from collections.abc import Callable, Hashable
from datetime import UTC, datetime, timedelta
from functools import cache
from http import HTTPStatus
from pathlib import Path
from typing import Any

from fastapi import Request
from fastapi.responses import HTMLResponse
from jinja2 import Environment, FileSystemLoader, StrictUndefined, select_autoescape
from markupsafe import Markup

from wildscav.terminal.console import printable
from wildscav_evaluator.output.results import MetricInfo
from wildscav_evaluator.scores.number_format import is_share, number
from wildscav_leaderboard.accounts.service import Caller

KEPT_PARTS = 64
FOLDER = Path(__file__).parent
STEPS = ((86_400, "d"), (3_600, "h"), (60, "min"), (1, "s"))


@cache
def environment() -> Environment:
    """Return the templates."""
    made = Environment(
        loader=FileSystemLoader(FOLDER / "templates"),
        autoescape=select_autoescape(default=True, default_for_string=True),
        finalize=_visible,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    filters = (moment, day, ago, duration, metric, amount, milliseconds, mebibytes)
    made.filters |= {one.__name__: one for one in filters}
    return made


def _visible(value: Any) -> Any:
    """Return a value of a template without characters that nobody sees, or that turn the text around them."""
    if isinstance(value, str) and not isinstance(value, Markup) and not value.isprintable():
        return printable(value, keep="\n\t")
    return value


def rendered(template: str, **values: Any) -> str:
    """Return the text of a template with some values."""
    return environment().get_template(template).render(**values)


def page(
    request: Request, template: str, caller: Caller | None, status: int = HTTPStatus.OK, **values: Any
) -> HTMLResponse:
    """Return a page."""
    season = getattr(request.state, "season", request.app.state.season)
    text = rendered(
        template,
        season=season,
        tracks=season.settings.tracks,
        visitor=caller,
        path=request.url.path,
        base=base_of(request),
        address=season.settings.web.address,  # in what people copy, so not as the request says
        **values,
    )
    return HTMLResponse(text, status, {"Cache-Control": "private, no-cache"})


def base_of(request: Request) -> str:
    """Return the address of the season's page, without a slash at its end."""
    url: str | None = request.app.state.season.settings.web.url
    return (url or str(request.base_url)).rstrip("/")


def metric(value: float, info: MetricInfo | None = None) -> str:
    """Return a value of a metric, or a rating."""
    return f"{value:,.0f}" if info is None else number(value, info)


def amount(value: float, info: MetricInfo) -> str:
    """Return a value of a metric in one match: a count without decimals."""
    is_count = not info.unit and value.is_integer() and not is_share(info)
    return f"{value:,.0f}" if is_count else metric(value, info)


def moment(value: datetime) -> str:
    """Return a time as it is shown, such as "2030-06-01 12:00 UTC"."""
    return f"{value.astimezone(UTC):%Y-%m-%d %H:%M} UTC"


def day(value: datetime) -> str:
    """Return a date as it is shown, such as "1 June 2030"."""
    return f"{value.astimezone(UTC):%-d %B %Y}"


def ago(value: datetime) -> str:
    """Return how long ago something was, or how long it will take, such as "3 h ago" or "in 2 d"."""
    passed = (datetime.now(UTC) - value).total_seconds()
    text = duration(abs(passed))
    return f"{text} ago" if passed >= 0 else f"in {text}"


def duration(seconds: float | timedelta) -> str:
    """Return a duration in its largest unit, such as "5 min"."""
    total = seconds.total_seconds() if isinstance(seconds, timedelta) else seconds
    for size, unit in STEPS:
        if total >= size:
            return f"{total / size:.0f} {unit}"
    return "0 s"


def milliseconds(seconds: float | None) -> str:
    """Return a short time in milliseconds."""
    return "" if seconds is None else f"{seconds * 1e3:,.1f}"


def mebibytes(size: int) -> str:
    """Return the size of a file."""
    return f"{size / (1 << 20):,.1f} MiB" if size >= 1 << 20 else f"{size / 1024:,.0f} KiB"


class PageParts:
    """Parts of pages that take long to make, by keys that change with them; the last ones are kept."""

    def __init__(self, most: int = KEPT_PARTS) -> None:
        self._most, self._lock = most, threading.Lock()
        self._parts: OrderedDict[Hashable, Markup] = OrderedDict()

    def get(self, key: Hashable, make: Callable[[], Markup]) -> Markup:
        """Return a part, which is made if it is not kept."""
        with self._lock:
            if key in self._parts:
                self._parts.move_to_end(key)
                return self._parts[key]
        part = make()  # perhaps twice at the same time, which is better than waiting for each other
        with self._lock:
            self._parts[key] = part
            while len(self._parts) > self._most:
                self._parts.popitem(last=False)
        return part
