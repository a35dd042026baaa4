"""Structured log lines on stderr, for servers and evaluations that nobody watches.

A line says when, what happened (a fixed word) and with what values: as JSON for machines, as text for people.
"""

import logging
import sys
from typing import Any, Literal, Protocol

LogFormat = Literal["json", "text"]


class Log(Protocol):
    """What log lines are written with."""

    def info(self, event: str, **values: Any) -> Any:
        """Write that something happened."""
        ...

    def warning(self, event: str, **values: Any) -> Any:
        """Write that something happened that somebody should look at."""
        ...


def open_log(form: LogFormat | None, **values: Any) -> Log:
    """Return a log.

    Args:
        form: Of its lines; none: nothing is written.
        values: What every line says beside its own.
    """
    import structlog

    renderer: Any = structlog.processors.JSONRenderer()
    if form == "text":
        renderer = structlog.dev.ConsoleRenderer(colors=sys.stderr.isatty())
    lowest = logging.INFO if form else logging.CRITICAL
    log: Log = structlog.wrap_logger(
        structlog.WriteLogger(sys.stderr),
        processors=[
            structlog.processors.add_log_level,
            structlog.processors.TimeStamper(fmt="iso", utc=True),
            renderer,
        ],
        wrapper_class=structlog.make_filtering_bound_logger(lowest),
        **values,
    )
    return log
