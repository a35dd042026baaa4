"""What ``wildscav compare`` shows."""

from collections.abc import Sequence
from dataclasses import replace

from rich.table import Table
from rich.text import Text

from wildscav.errors import UserError, describe
from wildscav.terminal.console import console, counted, print_json
from wildscav_evaluator.cli.result_tables import add_columns, heading, plain_table, sandbox_and_limits
from wildscav_evaluator.cli.sessions.evaluate import total_failures
from wildscav_evaluator.cli.sessions.playing import playing, raise_errors, say, say_ledger
from wildscav_evaluator.executors import Executor
from wildscav_evaluator.monitoring.monitor import MonitorOptions
from wildscav_evaluator.output.layout import COMPARISON_FILE
from wildscav_evaluator.output.results import write_results
from wildscav_evaluator.plans.evaluation import EvaluationPlan
from wildscav_evaluator.scores.compare import FEWEST_PAIRS, Comparison, compare
from wildscav_evaluator.scores.number_format import number, signed
from wildscav_evaluator.submissions.submission import Submission


def run_comparison(
    plan: EvaluationPlan,
    options: MonitorOptions,
    executor: Executor | None = None,
    *,
    as_json: bool = False,
) -> None:
    """Play two submissions on the same matches, and show and save which is better. See ``run_session``."""
    first, second = plan.submissions
    with playing(plan, options, executor) as (results, ledger):
        comparisons = compare(results, first.name, second.name)
        for one in comparisons.comparisons:
            console.print()
            console.print(comparison_table(one))
            console.print(verdict_line(one))
        if as_json:
            print_json({"folder": str(plan.out), **comparisons.as_json()})
        console.print()
        for line in sandbox_and_limits(results.sandbox, results.limits):
            console.print(f"played in {line}")
        try:
            ledger.close(results, write_results(results, plan.out))
            say("saved in", str(comparisons.write(plan.out / COMPARISON_FILE)))
            say_ledger(plan, ledger)
        except OSError as error:
            raise UserError(f"the comparison could not be saved: {describe(error)}") from error
    raise_errors(total_failures(results, plan.out))


def common_tracks(tracks: Sequence[str], submissions: Sequence[Submission]) -> tuple[str, ...]:
    """Return those of the tracks that all submissions play."""
    return tuple(name for name in tracks if all(name in one.manifest.tracks for one in submissions))


def with_distinct_names(submissions: Sequence[Submission]) -> tuple[Submission, ...]:
    """Return two submissions with distinct names: ``-a`` and ``-b`` are appended if their names are equal."""
    first, second = submissions
    if first.name != second.name:
        return first, second
    return tuple(
        replace(one, entered_as=f"{one.name[:38]}-{letter}") for one, letter in ((first, "a"), (second, "b"))
    )


def comparison_table(one: Comparison) -> Table:
    """Return the table of two submissions on one track: every metric, with the difference between them."""
    table = plain_table(f"{one.track} · {counted(one.pairs, 'match')} that both played")
    table.add_column("", vertical="bottom")
    add_columns(table, one.first, one.second, "difference", "95 %\ninterval")
    for difference in one.differences:
        metric = difference.metric
        table.add_row(
            " ".join(heading(metric).split()),
            number(difference.first, metric),
            number(difference.second, metric),
            signed(difference.difference, metric),
            f"{signed(difference.low, metric)} to {signed(difference.high, metric)}",
        )
    return table


def _said_of_interfaces(one: Comparison) -> str:
    if one.interfaces is None:
        return ""
    first, second = (interface or "numbers" for interface in one.interfaces)
    return f" ({one.first} plays by {first}, {one.second} by {second})"


def verdict_line(one: Comparison) -> Text:
    """Return in words which submission is better on a track."""
    dropped = _said_of_interfaces(one)
    dropped += f" ({counted(one.dropped, 'match')} left out: the platform failed)" if one.dropped else ""
    if one.verdict == "too few":
        return Text(
            f"{counted(one.pairs, 'match')} are too few to decide: at least {FEWEST_PAIRS} needed{dropped}",
            "yellow",
        )
    title = one.differences[0].metric.title
    if one.verdict == "tied":
        return Text(f"tied: the {title} does not distinguish them{dropped}", "yellow")
    better, worse = (one.first, one.second) if one.verdict == "first" else (one.second, one.first)
    return Text(f"{better} is better than {worse} by its {title}{dropped}", "green")
