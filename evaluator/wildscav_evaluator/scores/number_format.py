"""The format of metrics' values in tables, on the dashboard and in progress lines."""

from wildscav_evaluator.output.results import MetricInfo

NOTHING = "-"  # shown if there is no value


def number(value: float, metric: MetricInfo) -> str:
    """Return a value as text; rates as percent."""
    return f"{value:.0%}" if metric.title.endswith("rate") else f"{value:.1f}"


def signed(value: float, metric: MetricInfo) -> str:
    """Return a difference as text, with its sign."""
    text = number(abs(value), metric)
    return f"−{text}" if value < 0 and text.strip("0.%") else f"+{text}"


def unit_and_title(metric: MetricInfo) -> str:
    """Return a metric's unit and title, to be written after a number."""
    unit = f"{metric.unit} " if metric.unit and not metric.title.endswith("rate") else ""
    return f"{unit}{metric.title}"
