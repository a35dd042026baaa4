"""What ``wildscav price`` plays and shows."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace

from rich.table import Table

from wildscav.errors import UserError, describe
from wildscav.terminal.console import console, print_json
from wildscav_engine.specs.thinking import ClockChoice
from wildscav_evaluator.cli.options.selection import clock_choice
from wildscav_evaluator.cli.result_tables import add_columns, heading, plain_table
from wildscav_evaluator.cli.sessions.playing import playing, raise_errors, saving_errors, say
from wildscav_evaluator.executors import Executor
from wildscav_evaluator.monitoring.monitor import MonitorOptions
from wildscav_evaluator.output.results import Results
from wildscav_evaluator.plans.evaluation import EvaluationPlan
from wildscav_evaluator.scores.number_format import number
from wildscav_evaluator.scores.price import PRICE_FILE, PRICE_PICTURE, Price, draw_price, label_of, price_of
from wildscav_evaluator.submissions.slowed import slowed
from wildscav_evaluator.submissions.submission import Submission
from wildscav_server import leftovers


def clocks_of(paces: str) -> tuple[ClockChoice, ...]:
    """Return the clocks by which to play: ``paused``, then ``running`` at paces of which no two are equal."""
    clocks = tuple(
        clock_choice(f"running,pace={pace.strip()}", f"--paces {paces}") for pace in paces.split(",")
    )
    if len(set(map(str, clocks))) < len(clocks):
        raise UserError(f"--paces {paces}: a pace is given twice", 2)
    return ClockChoice(clock="paused"), *clocks


@contextmanager
def thinking_longer(submission: Submission, seconds: float) -> Iterator[Submission]:
    """Yield a submission that thinks longer in each decision, or the same one if it is to take 0 s more."""
    if not seconds:
        yield submission
        return
    with leftovers.temporary_folder("slowed-") as folder:
        yield slowed(submission, seconds, folder / submission.name)


def run_price(
    plan: EvaluationPlan,
    clocks: Sequence[ClockChoice],
    options: MonitorOptions,
    executor: Executor | None = None,
    *,
    think: float = 0.0,
    as_json: bool = False,
) -> None:
    """Play the matches of a plan by each clock, and show and save the price of thinking.

    ``think`` is by how many seconds every decision is slowed down on purpose.
    """
    played = []
    for clock in clocks:
        name = label_of(clock).replace(" ", "-")
        of_clock = replace(plan, suite=replace(plan.suite, clock=clock), out=plan.out / name)
        played.append(_played(of_clock, options, executor))
    try:
        price = price_of(played, think)
    except ValueError as error:
        raise UserError(str(error)) from error
    console.print()
    console.print(price_table(price))
    if as_json:
        print_json({"folder": str(plan.out), **price.as_json()})
    try:
        path = price.write(plan.out / PRICE_FILE)
        picture = draw_price(price, plan.out / PRICE_PICTURE)
    except OSError as error:
        raise UserError(f"the price could not be saved: {describe(error)}") from error
    say("price", str(path))
    say("picture", str(picture))


def _played(plan: EvaluationPlan, options: MonitorOptions, executor: Executor | None) -> Results:
    console.print(f"clock     {plan.suite.clock}")
    with playing(plan, options, executor) as (results, ledger):
        raise_errors(saving_errors(results, plan.out, ledger))
        return results


def price_table(price: Price) -> Table:
    """Return the table: one line for each clock."""
    table = plain_table(price.title)
    table.add_column("clock", vertical="bottom", no_wrap=True)
    add_columns(table, "thinking\n[s]", "delay\n[game s]", heading(price.metric), "95 %\ninterval", "failed")
    for point in price.points:
        score = point.score
        table.add_row(
            label_of(point.clock),
            f"{point.thinking:.3f}",
            f"{point.delay:.3f}",
            number(score.mean, price.metric),
            f"{number(score.low, price.metric)} to {number(score.high, price.metric)}",
            str(point.faults),
        )
    return table
