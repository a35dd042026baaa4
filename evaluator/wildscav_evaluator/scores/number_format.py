"""The format of metrics' values in tables, on the dashboard and in progress lines."""

from wildscav_evaluator.output.results import MetricInfo

NOTHING = "-"  # shown if there is no value
SHARES = ("rate", "SPL")  # the last words of the titles of metrics from 0 to 1


def is_share(metric: MetricInfo) -> bool:
    """Return whether a metric is shown as percent."""
    return metric.title.endswith(SHARES)


def number(value: float, metric: MetricInfo) -> str:
    """Return a value as text; rates and SPL as percent."""
    return f"{value:.0%}" if is_share(metric) else f"{value:.1f}"


def signed(value: float, metric: MetricInfo) -> str:
    """Return a difference as text, with its sign."""
    text = number(abs(value), metric)
    return f"−{text}" if value < 0 and text.strip("0.%") else f"+{text}"


def unit_and_title(metric: MetricInfo) -> str:
    """Return a metric's unit and title, to be written after a number."""
    unit = f"{metric.unit} " if metric.unit and not is_share(metric) else ""
    return f"{unit}{metric.title}"
