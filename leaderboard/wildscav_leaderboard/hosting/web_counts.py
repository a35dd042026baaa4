"""Everything that one web server counts."""

from collections.abc import Iterable
from dataclasses import dataclass, field

from prometheus_client.core import Metric

from wildscav_leaderboard.hosting.request_log import RequestCounts
from wildscav_leaderboard.playing.table_counts import TableCounts


@dataclass(frozen=True)
class WebCounts:
    """The requests of a web server, and the tables on its site."""

    requests: RequestCounts = field(default_factory=RequestCounts)
    tables: TableCounts = field(default_factory=TableCounts)

    def collect(self) -> Iterable[Metric]:
        """Return the counts for Prometheus."""
        yield from self.requests.collect()
        yield from self.tables.collect()
