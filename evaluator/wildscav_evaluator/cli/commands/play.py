"""The command ``wildscav play``."""

from pathlib import Path
from typing import Annotated

import typer

from wildscav.cli.shared_options import AsJson, RulesOption
from wildscav.errors import UserError, describe
from wildscav.system.output_folders import check_folder
from wildscav_evaluator.cli.options.evaluation import Submissions
from wildscav_evaluator.cli.options.running import InSandbox, ModelOption, chosen_model, chosen_sandbox


def play(
    submissions: Submissions,
    track: Annotated[
        str | None, typer.Option(help="Track to play. Default: the first submission's first track.")
    ] = None,
    map_seed: Annotated[
        int,
        typer.Option(
            "--map-seed",
            help="Seed from which the map is generated; it is not the number of a numbered map.",
            min=0,
            max=2**64 - 1,
        ),
    ] = 0,
    size: Annotated[int, typer.Option(help="Side of the map, m.", min=40, max=2000)] = 100,
    seed: Annotated[int, typer.Option(help="Seed of the match.", min=0, max=2**64 - 1)] = 0,
    robots: Annotated[
        str | None,
        typer.Option(
            help="Robots in further seats: how many, or which, such as fighter,gatherer-hard. Default: in "
            "battle, up to six seats in all.",
            show_default=False,
        ),
    ] = None,
    time_limit: Annotated[float, typer.Option(help="Seconds of game time.", min=0.1, max=86_400)] = 60.0,
    rules: RulesOption = "original",
    record: Annotated[Path | None, typer.Option(help="Save the record of the match to this file.")] = None,
    replay: Annotated[
        Path | None, typer.Option(help="Render the match as a Rerun recording to this file (.rrd).")
    ] = None,
    logs: Annotated[
        Path | None,
        typer.Option(
            help="Folder for the agents' output; what it has of an earlier match is replaced. Default: a new "
            "numbered folder in out/play.",
            show_default=False,
        ),
    ] = None,
    sandbox: InSandbox = None,
    model: ModelOption = None,
    as_json: AsJson = False,
) -> None:
    """Play one match, each agent in its own sandbox. With --model, the clock is paused while agents think.

    With --json: `track`, `map`, `seed`, `seconds`, `metrics`, `logs` (their folder, if agents printed
    anything), and `seats`: `seat`, `name`, `metrics`, `status`, `detail` of each.
    """
    from wildscav_evaluator.cli.options.selection import check_plays, load_submissions, tracks_played
    from wildscav_evaluator.cli.sessions.play import make_spec, run_match
    from wildscav_evaluator.output.numbered_folders import PLAYED

    check_folder("--logs", logs or PLAYED, is_default=logs is None)
    loaded = load_submissions(submissions)
    chosen = tracks_played(loaded, [track] if track else list(loaded[0].manifest.tracks[:1]))[0]
    for submission in loaded:
        check_plays(submission, chosen)
    spec = make_spec(
        chosen,
        submissions=len(loaded),
        robots=robots,
        map_seed=map_seed,
        size=size,
        seed=seed,
        time_limit=time_limit,
        rules=rules,
        clock="bank" if model is None else "paused",  # models take longer than a bank lasts
    )
    asked = chosen_model(model, loaded)
    runs_in, loaded = chosen_sandbox(sandbox, loaded)
    files = (record, replay, logs)
    try:
        run_match(spec, loaded, *files, sandbox=runs_in, model=asked, as_json=as_json)
    except OSError as error:
        raise UserError(describe(error)) from error
