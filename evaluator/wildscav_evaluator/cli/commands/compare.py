"""The command ``wildscav compare``."""

from pathlib import Path
from typing import Annotated

import typer

from wildscav.cli.shared_options import takes
from wildscav.errors import UserError
from wildscav_evaluator.cli.options.evaluation import PlayOptions, RoundsOption


@takes(PlayOptions)
def compare(
    options: PlayOptions,
    first: Annotated[Path, typer.Argument(help="A folder with a submission.toml.", metavar="A")],
    second: Annotated[
        Path, typer.Argument(help="Another submission, or another version of the first.", metavar="B")
    ],
    track: Annotated[
        list[str] | None,
        typer.Option(help="Compare on this track; may be repeated. Default: all tracks that both play."),
    ] = None,
    rounds: RoundsOption = 2,
) -> None:
    """Play two submissions on the same matches, and report which is better, or that they are tied.

    The verdict comes from a paired bootstrap: one is better if the 95 % interval of the differences, match by
    match, excludes zero. The same command continues a comparison that was interrupted.

    With --json: `folder`, and what comparison.json has: `format`, `versions`, `suite`, `seed`, `rounds`,
    `sandbox`, `limits`, `comparisons`.
    """
    from wildscav_evaluator.cli.options.selection import load_submissions, suite_tracks
    from wildscav_evaluator.cli.sessions.compare import common_tracks, run_comparison, with_distinct_names
    from wildscav_evaluator.output.numbered_folders import COMPARISONS
    from wildscav_evaluator.plans.evaluation import EvaluationPlan

    loaded, suite = with_distinct_names(load_submissions([first, second])), options.find_suite()
    tracks = common_tracks(suite_tracks(loaded, track or [], suite), loaded)
    if not tracks:
        raise UserError(f"suite {suite.name} has no track that both {first} and {second} play", exit_code=2)
    with options.planned(
        EvaluationPlan, loaded, COMPARISONS, suite=suite, tracks=tracks, rounds=rounds, replays="none"
    ) as (plan, machines):
        run_comparison(plan, options.monitor, machines, as_json=options.as_json)
