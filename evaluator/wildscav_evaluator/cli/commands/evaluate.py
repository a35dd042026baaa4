"""The command ``wildscav evaluate``.

The command line imports this module to show its help, so heavy modules are imported only when the command
runs.
"""

from pathlib import Path
from typing import Annotated, Literal

import typer

from wildscav.cli.json_option import AsJson
from wildscav_evaluator.cli.options.evaluation import (
    DatabaseOption,
    FreshOption,
    JobsOption,
    LogOption,
    MetricsOption,
    OutOption,
    SecretOption,
    SeedOption,
    Submissions,
    SuiteOption,
)
from wildscav_evaluator.cli.options.executor import AddressOption, ExecutorOption, executor_of
from wildscav_evaluator.cli.options.sandbox import InSandbox, chosen_sandbox
from wildscav_evaluator.cli.options.signing import SignOption, signing_key, warn_of_open_key


def evaluate(
    submissions: Submissions,
    track: Annotated[
        list[str] | None,
        typer.Option(help="Evaluate on this track; may be repeated. Default: all tracks of each submission."),
    ] = None,
    suite: SuiteOption = "quick",
    seed: SeedOption = None,
    secret: SecretOption = None,
    jobs: JobsOption = None,
    replays: Annotated[
        Literal["none", "first", "all"],
        typer.Option(help="Which matches of each submission and track to render as Rerun recordings."),
    ] = "first",
    out: OutOption = None,
    fresh: FreshOption = False,
    db: DatabaseOption = Path("out/wildscav.db"),
    sandbox: InSandbox = None,
    executor: ExecutorOption = "local",
    address: AddressOption = None,
    sign: SignOption = None,
    log_format: LogOption = None,
    metrics_port: MetricsOption = None,
    as_json: AsJson = False,
) -> None:
    """Evaluate submissions on seeded suites of matches, each agent in its own sandbox.

    The same command continues an evaluation that was interrupted. Submissions never meet: where a match has
    several seats for submissions, the submission that is evaluated fills all of them.
    """
    from wildscav_evaluator.cli.options.selection import load_submissions, suite_seed, suite_tracks
    from wildscav_evaluator.cli.sessions.evaluate import run_session
    from wildscav_evaluator.monitoring.monitor import MonitorOptions
    from wildscav_evaluator.output.numbered_folders import EVALUATIONS
    from wildscav_evaluator.plans.evaluation import EvaluationPlan
    from wildscav_evaluator.suites.suite_file import find_suite

    loaded, chosen = load_submissions(submissions), find_suite(suite)
    tracks, first = suite_tracks(loaded, track or [], chosen), suite_seed(seed, secret)
    key = signing_key(sign, out or EVALUATIONS, loaded)
    with executor_of(executor, address, jobs) as machines:
        runs_in, loaded = chosen_sandbox(sandbox, loaded, machines)
        if key is not None:
            warn_of_open_key(runs_in)
        plan = EvaluationPlan(
            submissions=loaded,
            tracks=tracks,
            suite=chosen,
            seed=first,
            replays=replays,
            jobs=machines.at_once,
            out=out or EVALUATIONS,
            fresh=fresh,
            sandbox=runs_in,
            key=key,
        )
        options = MonitorOptions(log_format, metrics_port)
        run_session(plan if out else plan.in_own_folder(), db, options, machines, as_json=as_json)
