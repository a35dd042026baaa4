"""Readable tables of results."""

from collections.abc import Iterable, Sequence

from rich.table import Table

from wildscav_evaluator.results import Evaluation, MetricInfo, Results, Summary


def track_table(results: Results, track: str) -> Table:
    """Return the table of one track: the submissions from best to worst."""
    evaluations = [one for one in results.evaluations if one.track == track]
    metrics = evaluations[0].metrics
    count = max(len(one.matches) for one in evaluations)
    table = Table(
        title=f"{track} · suite {results.suite} · seed {results.seed} · {count} matches each",
        title_justify="left",
        title_style="bold",
    )
    table.add_column("rank", justify="right")
    table.add_column("submission")
    for metric in metrics:
        table.add_column(heading(metric), justify="right")
    table.add_column("matches", justify="right")
    table.add_column("failures", justify="right")
    for rank, one in ranked(evaluations):
        table.add_row(*_cells(rank, one))
    return table


def heading(metric: MetricInfo) -> str:
    """Return a column's heading: title and unit, and on a second line which way is better."""
    title = f"{metric.title} [{metric.unit}]" if metric.unit else metric.title
    return title.replace("[", r"\[") + ("\n↓ better" if metric.lower_is_better else "\n↑ better")


def ranked(evaluations: Iterable[Evaluation]) -> list[tuple[int | None, Evaluation]]:
    """Return evaluations of one track in order, with their ranks; equal scores share one.

    Those without a score come last and have no rank.
    """
    scored = sorted(
        (one for one in evaluations if one.score is not None), key=lambda one: (_order(one), one.submission)
    )
    ranks = [1 + sum(_order(other) < _order(one) for other in scored) for one in scored]
    unscored = [(None, one) for one in evaluations if one.score is None]
    return [*zip(ranks, scored, strict=True), *unscored]


def _order(evaluation: Evaluation) -> float:
    mean = evaluation.summary[evaluation.metrics[0].name].mean
    return mean if evaluation.metrics[0].lower_is_better else -mean


def _cells(rank: int | None, evaluation: Evaluation) -> Sequence[str]:
    values = [
        summary_text(evaluation.summary.get(metric.name), metric, with_interval=position == 0)
        for position, metric in enumerate(evaluation.metrics)
    ]
    faults = evaluation.faults
    return (
        "-" if rank is None else str(rank),
        f"{evaluation.submission} {evaluation.version}",
        *values,
        str(sum(row.metrics is not None for row in evaluation.matches)),
        f"[red]{faults}[/red]" if faults else "0",
    )


def summary_text(summary: Summary | None, metric: MetricInfo, *, with_interval: bool) -> str:
    """Return a metric's mean as text, with its 95 % interval if asked for."""
    if summary is None:
        return "-"
    mean = number(summary.mean, metric)
    if not with_interval:
        return mean
    return f"[bold]{mean}[/bold] ({number(summary.low, metric)} to {number(summary.high, metric)})"


def number(value: float, metric: MetricInfo) -> str:
    """Return a value as text; rates as percent."""
    return f"{value:.0%}" if metric.title.endswith("rate") else f"{value:.1f}"
