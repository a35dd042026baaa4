"""The command ``wildscav evaluate``.

The command line imports this module to show its help, so heavy modules are imported only when the command
runs.
"""

from typing import Annotated, Literal

import typer

from wildscav.cli.shared_options import takes
from wildscav_evaluator.cli.options.evaluation import NoDatabase, PlayOptions, Submissions


@takes(PlayOptions)
def evaluate(
    options: PlayOptions,
    submissions: Submissions,
    track: Annotated[
        list[str] | None,
        typer.Option(help="Evaluate on this track; may be repeated. Default: all tracks of each submission."),
    ] = None,
    replays: Annotated[
        Literal["none", "first", "all"],
        typer.Option(help="Which matches of each submission and track to render as Rerun recordings."),
    ] = "first",
    db: NoDatabase = None,  # noqa: ARG001 - its callback says what replaced it
) -> None:
    """Evaluate submissions on seeded suites of matches, each agent in its own sandbox.

    The same command continues an evaluation that was interrupted. Submissions never meet: where a match has
    several seats for submissions, the submission that is evaluated fills all of them.

    With --json: `folder`, `results` (as in results.json), and `since_last`: `folder`, `version` and
    `comparison` of each submission and track that was evaluated before, where `first` is now and `second` is
    then.
    """
    from wildscav_evaluator.cli.options.selection import load_submissions, suite_tracks
    from wildscav_evaluator.cli.sessions.evaluate import run_session
    from wildscav_evaluator.output.numbered_folders import EVALUATIONS
    from wildscav_evaluator.plans.evaluation import EvaluationPlan

    loaded, suite = load_submissions(submissions), options.find_suite()
    tracks = suite_tracks(loaded, track or [], suite)
    with options.planned(
        EvaluationPlan, loaded, EVALUATIONS, suite=suite, tracks=tracks, replays=replays
    ) as (plan, machines):
        run_session(plan, options.monitor, machines, as_json=options.as_json)
