"""The reference of metrics for Prometheus: those of evaluations, of match servers, and of seasons."""

from collections.abc import Iterable
from pathlib import Path
from tempfile import TemporaryDirectory

from prometheus_client import Metric

from wildscav_evaluator.executors import Node
from wildscav_evaluator.monitoring.monitor import EvaluationMetrics
from wildscav_evaluator.monitoring.tally import Tally
from wildscav_leaderboard.hosting.metrics import SeasonMetrics
from wildscav_leaderboard.hosting.request_log import WebCounts
from wildscav_leaderboard.seasons.folder import Season
from wildscav_leaderboard.seasons.initial_files import make_season_folder
from wildscav_server.server_metrics import ServerMetrics
from wildscav_website.markdown import code, sentence, table

HEAD = """# Metrics

What `--metrics-port` serves to Prometheus on 127.0.0.1.
"""


def page() -> str:
    """Return the page."""
    evaluation = EvaluationMetrics(Tally([], nodes=lambda: (Node("one", cores=1),)))
    parts = [
        ("An evaluation", "`wildscav evaluate` and `wildscav tournament`", evaluation.collect()),
        ("A match server", "`wildscav serve`", ServerMetrics(list, lambda: 0).collect()),
        ("A season", "`wildscav season serve`", _of_season()),
    ]
    told = (f"## {title}\n\nServed by {command}.\n\n{_table(found)}" for title, command, found in parts)
    return "\n".join([HEAD, *told])


def _of_season() -> list[Metric]:
    """Return the metrics of a season in which nothing has happened."""
    with TemporaryDirectory() as folder:
        make_season_folder(Path(folder) / "season", None, None, days=1)
        season = Season.open(Path(folder) / "season")
        database = season.database()
        database.upgrade()
        counts = WebCounts()
        counts.requests.add("GET", "/", 200, 0.0)
        counts.tables.end(failed=False)
        found = list(SeasonMetrics(season, database, counts).collect())
        database.close()
    return found


def _table(metrics: Iterable[Metric]) -> str:
    rows = [
        (code(f"{one.name}{'_total' * (one.type == 'counter')}"), _labels(one), sentence(one.documentation))
        for one in metrics
    ]
    return table(("metric", "labels", ""), rows)


def _labels(metric: Metric) -> str:
    """Return the names of a metric's labels; a family that counts itself tells them only in its samples."""
    samples = [name for one in metric.samples[:1] for name in one.labels if name != "le"]
    return ", ".join(map(code, getattr(metric, "_labelnames", samples)))
