"""Structured log lines on stderr, for servers and evaluations that run unattended.

A line has a time, an event (a fixed word) and values: as JSON for machines, as text for people. Values may
come from agents, so they are escaped: none of them can control a terminal.
"""

import json
import logging
import sys
from collections.abc import MutableMapping
from typing import Any, Literal, Protocol

LogFormat = Literal["json", "text"]


class Log(Protocol):
    """The interface through which log lines are written."""

    def info(self, event: str, **values: Any) -> Any:
        """Write that something happened."""
        ...

    def warning(self, event: str, **values: Any) -> Any:
        """Write that something happened that needs attention."""
        ...


def open_log(form: LogFormat | None, **values: Any) -> Log:
    """Return a log, which without a form writes nothing; the values are added to every line."""
    import structlog

    renderer: Any = structlog.processors.JSONRenderer(_as_json)
    if form == "text":
        renderer = structlog.dev.ConsoleRenderer(colors=sys.stderr.isatty())
    lowest = logging.INFO if form else logging.CRITICAL
    log: Log = structlog.wrap_logger(
        structlog.WriteLogger(sys.stderr),
        processors=[
            structlog.processors.add_log_level,
            structlog.processors.TimeStamper(fmt="iso", utc=True),
            *([_made_plain] if form == "text" else []),
            renderer,
        ],
        wrapper_class=structlog.make_filtering_bound_logger(lowest),
        **values,
    )
    return log


def _as_json(values: dict[str, Any], **options: Any) -> str:
    from wildscav.terminal.console import ascii_json

    return ascii_json(json.dumps(values, **options))


def _made_plain(_logger: Any, _method: str, values: MutableMapping[str, Any]) -> dict[str, Any]:
    """Return the values of a line with all strings escaped; others are shown by ``repr``, which escapes."""
    from wildscav.terminal.console import printable

    return {name: printable(value) if isinstance(value, str) else value for name, value in values.items()}
