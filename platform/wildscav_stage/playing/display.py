"""The scores of all, which everybody is shown."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from wildscav_engine.simulation.match import Match


def scores_of(match: "Match", names: Sequence[str]) -> list[dict[str, Any]]:
    """Return the track's metrics of every seat so far, the best first by the first metric."""
    metrics = match.track.metrics
    rows = []
    for seat, name in enumerate(names):
        values = match.track.measure(match, seat)
        rows.append({"seat": seat, "name": name, "values": [values[metric.name] for metric in metrics]})
    sign = 1.0 if metrics[0].lower_is_better else -1.0
    return sorted(rows, key=lambda row: sign * row["values"][0])


def metric_titles(match: "Match") -> list[dict[str, str]]:
    """Return the titles and units of the metrics in ``scores_of``."""
    return [{"title": metric.title, "unit": metric.unit} for metric in match.track.metrics]
