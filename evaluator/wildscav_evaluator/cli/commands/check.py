"""The command ``wildscav check``."""

from pathlib import Path
from typing import Annotated

import typer

from wildscav.cli.shared_options import AsJson
from wildscav.errors import UserError, describe
from wildscav.system.output_folders import check_folder
from wildscav_evaluator.cli.options.evaluation import SuiteOption
from wildscav_evaluator.cli.options.running import InSandbox, ModelOption, chosen_model, chosen_sandbox


def check(
    submission: Annotated[
        Path,
        typer.Argument(
            help="A submission: a folder, an archive or an image, as for evaluate.",
            metavar="SUBMISSION",
            show_default=False,
        ),
    ],
    logs: Annotated[Path, typer.Option(help="Folder for the agent's output.")] = Path("out/check"),
    suite: SuiteOption = "quick",
    season: Annotated[
        str | None,
        typer.Option(
            help="Address of a season, whose sandbox, limits and suites are used; --suite only where the "
            "season's own is hidden.",
            metavar="URL",
            show_default=False,
        ),
    ] = None,
    sandbox: InSandbox = None,
    model: ModelOption = None,
    as_json: AsJson = False,
) -> None:
    """Check whether a submission keeps the rules, in the judge's sandbox with its clock and its limits.

    The submission plays the beginning of a match of the suite on each of its tracks, one in which it is often
    late, and one that is cancelled. Every failure is explained, with advice on how to fix it. With --model,
    the clock is paused while the agent thinks, except with --season.

    With --json: `submission`, `version`, `passed`, `logs`, and `findings`: `check`, `verdict` (`ok`,
    `warning` or `failed`), `seen`, `advice`, `last_lines` of each.
    """
    from wildscav_evaluator.check.season import SeasonRules
    from wildscav_evaluator.check.trials import Trial
    from wildscav_evaluator.cli.options.selection import load_submissions, suite_tracks
    from wildscav_evaluator.cli.sessions.check import run_check
    from wildscav_evaluator.sandbox import DEFAULT_LIMITS, SANDBOXES
    from wildscav_evaluator.suites.suite_file import find_suite

    check_folder("--logs", logs)
    loaded, chosen = load_submissions([submission]), find_suite(suite)
    if season is not None:
        rules = SeasonRules.of(season)
        sandbox, trials = sandbox or rules.validation.sandbox, rules.trials(loaded[0], suite)
    else:
        limits = {
            track: chosen.limits.get(track, DEFAULT_LIMITS) for track in suite_tracks(loaded, [], chosen)
        }
        trials = {track: Trial.of(chosen, track, limits[track], seed=0) for track in limits}
    asked = chosen_model(model, loaded)
    if asked is not None:
        trials = {track: trial.asking(asked, paused=season is None) for track, trial in trials.items()}
    name, (runs,) = chosen_sandbox(sandbox, loaded)
    try:
        run_check(runs, SANDBOXES[name], logs, trials, as_json=as_json)
    except OSError as error:
        raise UserError(describe(error)) from error
