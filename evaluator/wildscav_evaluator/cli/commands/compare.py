"""The command ``wildscav compare``."""

from pathlib import Path
from typing import Annotated

import typer

from wildscav.cli.json_option import AsJson
from wildscav.errors import UserError
from wildscav_evaluator.bounds import MOST_ROUNDS
from wildscav_evaluator.cli.options.evaluation import (
    FreshOption,
    JobsOption,
    LogOption,
    MetricsOption,
    OutOption,
    SecretOption,
    SeedOption,
    SuiteOption,
)
from wildscav_evaluator.cli.options.executor import AddressOption, ExecutorOption, executor_of
from wildscav_evaluator.cli.options.sandbox import InSandbox, chosen_sandbox
from wildscav_evaluator.cli.options.signing import SignOption, signing_key, warn_of_open_key


def compare(
    first: Annotated[Path, typer.Argument(help="A folder with a submission.toml.", metavar="A")],
    second: Annotated[
        Path, typer.Argument(help="Another submission, or another version of the first.", metavar="B")
    ],
    track: Annotated[
        list[str] | None,
        typer.Option(help="Compare on this track; may be repeated. Default: all tracks that both play."),
    ] = None,
    suite: SuiteOption = "quick",
    rounds: Annotated[
        int,
        typer.Option(
            help="How often to play the suite, each time with the next seed.", min=1, max=MOST_ROUNDS
        ),
    ] = 2,
    seed: SeedOption = None,
    secret: SecretOption = None,
    jobs: JobsOption = None,
    out: OutOption = None,
    fresh: FreshOption = False,
    sandbox: InSandbox = None,
    executor: ExecutorOption = "local",
    address: AddressOption = None,
    sign: SignOption = None,
    log_format: LogOption = None,
    metrics_port: MetricsOption = None,
    as_json: AsJson = False,
) -> None:
    """Play two submissions on the same matches, and report which is better, or that they are tied.

    The verdict comes from a paired bootstrap: one is better if the 95 % interval of the differences, match by
    match, excludes zero. The same command continues a comparison that was interrupted.
    """
    from wildscav_evaluator.cli.options.selection import load_submissions, suite_seed, suite_tracks
    from wildscav_evaluator.cli.sessions.compare import common_tracks, run_comparison, with_distinct_names
    from wildscav_evaluator.monitoring.monitor import MonitorOptions
    from wildscav_evaluator.output.numbered_folders import COMPARISONS
    from wildscav_evaluator.plans.evaluation import EvaluationPlan
    from wildscav_evaluator.suites.suite_file import find_suite

    loaded, chosen = with_distinct_names(load_submissions([first, second])), find_suite(suite)
    tracks = common_tracks(suite_tracks(loaded, track or [], chosen), loaded)
    if not tracks:
        raise UserError(f"suite {chosen.name} has no track that both {first} and {second} play", exit_code=2)
    first_seed = suite_seed(seed, secret)
    key = signing_key(sign, out or COMPARISONS, loaded)
    with executor_of(executor, address, jobs) as machines:
        runs_in, loaded = chosen_sandbox(sandbox, loaded, machines)
        if key is not None:
            warn_of_open_key(runs_in)
        plan = EvaluationPlan(
            submissions=loaded,
            tracks=tracks,
            suite=chosen,
            seed=first_seed,
            replays="none",
            jobs=machines.at_once,
            out=out or COMPARISONS,
            fresh=fresh,
            rounds=rounds,
            sandbox=runs_in,
            key=key,
        )
        options = MonitorOptions(log_format, metrics_port)
        run_comparison(plan if out else plan.in_own_folder(), options, machines, as_json=as_json)
