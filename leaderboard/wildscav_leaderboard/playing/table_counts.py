"""How many people play on a season's site, for Prometheus."""

from collections.abc import Iterable

from prometheus_client import Counter, Gauge
from prometheus_client.core import Metric


class TableCounts:
    """How many tables there are, and how they ended."""

    def __init__(self) -> None:
        self._open = Gauge(
            "wildscav_season_tables", "Tables at which people play against submissions.", registry=None
        )
        self._ended = Counter(
            "wildscav_season_tables_ended", "Tables that have ended.", ("outcome",), registry=None
        )

    def open(self) -> None:
        """Count a table that was opened."""
        self._open.inc()

    def end(self, *, failed: bool) -> None:
        """Count the end of a table.

        Args:
            failed: Whether it ended because something went wrong.
        """
        self._open.dec()
        self._ended.labels("failed" if failed else "over").inc()

    def collect(self) -> Iterable[Metric]:
        """Return the counts for Prometheus."""
        yield from self._open.collect()
        yield from self._ended.collect()
