"""The commands ``wildscav play`` and ``wildscav evaluate``.

The command line imports this to show its help: what is heavy is imported when a command runs.
"""

from pathlib import Path
from typing import Annotated, Literal

import typer

from wildscav.cli.json_option import AsJson
from wildscav.errors import UserError, describe
from wildscav.system.output_folders import check_folder
from wildscav_evaluator.cli.options.sandbox import InSandbox, chosen_sandbox
from wildscav_evaluator.cli.options.signing import SignOption, signing_key, warn_of_open_key

Submissions = Annotated[
    list[Path],
    typer.Argument(
        help="Folders with a submission.toml, archives of such, image:NAME, or the baselines random, homing "
        "and hunter.",
        metavar="SUBMISSION",
        show_default=False,
    ),
]

SuiteOption = Annotated[
    str,
    typer.Option(
        help="Which matches. quick: 3 to 5 short ones a track, on small maps. official: the competition's, "
        "on large maps (100 of navigation, gathering and capture, 10 of battle and royale). Or the file of a "
        "suite of your own (.toml)."
    ),
]
SeedOption = Annotated[
    int | None,
    typer.Option(
        help="Seed of the suite: another seed gives other maps. Default: 0.", min=0, show_default=False
    ),
]
SecretOption = Annotated[
    Path | None,
    typer.Option(
        help="File with a hidden seed (`wildscav secret new`), instead of --seed.", show_default=False
    ),
]
OutOption = Annotated[
    Path | None,
    typer.Option(
        help="Output folder. Default: a new one with the next number, or the one in which the same command "
        "was interrupted.",
        show_default=False,
    ),
]
FreshOption = Annotated[
    bool,
    typer.Option(
        "--fresh",
        help="Play everything again: into a new folder or, with --out, in place of what that folder holds.",
        show_default=False,
    ),
]
JobsOption = Annotated[
    int | None,
    typer.Option(help="Matches at once. Default: one a processor core.", min=1, show_default=False),
]

LogOption = Annotated[
    Literal["json", "text"] | None,
    typer.Option(help="Write log lines of this form to stderr, instead of a dashboard.", show_default=False),
]
MetricsOption = Annotated[
    int | None,
    typer.Option(
        help="Serve Prometheus metrics on this port of this machine; 0 takes a free one.",
        min=0,
        max=65_535,
        show_default=False,
    ),
]


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
    db: Annotated[Path, typer.Option(help="The leaderboard's database.")] = Path("out/wildscav.db"),
    sandbox: InSandbox = None,
    sign: SignOption = None,
    log_format: LogOption = None,
    metrics_port: MetricsOption = None,
    as_json: AsJson = False,
) -> None:
    """Evaluate submissions on seeded suites of matches, each agent in a sandbox of its own.

    An evaluation that was interrupted is continued by the same command. Submissions do not meet: where a
    match has several seats for submissions, all of them are filled by the one that is evaluated.
    """
    from wildscav_engine.parallel.threads import cores
    from wildscav_evaluator.cli.options.selection import load_submissions, suite_seed, suite_tracks
    from wildscav_evaluator.cli.sessions.evaluate import run_session
    from wildscav_evaluator.evaluation import Plan, in_own_folder
    from wildscav_evaluator.monitoring.monitor import Watching
    from wildscav_evaluator.output.numbered_folders import EVALUATIONS
    from wildscav_evaluator.suites.suite_file import find_suite

    loaded, chosen = load_submissions(submissions), find_suite(suite)
    tracks, first = suite_tracks(loaded, track or [], chosen), suite_seed(seed, secret)
    key = signing_key(sign, out or EVALUATIONS, loaded)
    runs_in, loaded = chosen_sandbox(sandbox, loaded)
    if key is not None:
        warn_of_open_key(runs_in)
    plan = Plan(
        submissions=loaded,
        tracks=tracks,
        suite=chosen,
        seed=first,
        replays=replays,
        jobs=jobs or cores(),
        out=out or EVALUATIONS,
        fresh=fresh,
        sandbox=runs_in,
        key=key,
    )
    run_session(plan if out else in_own_folder(plan), db, Watching(log_format, metrics_port), as_json=as_json)


def play(
    submissions: Submissions,
    track: Annotated[
        str | None, typer.Option(help="What to play. Default: the first submission's first track.")
    ] = None,
    map_seed: Annotated[
        int,
        typer.Option(
            "--map",
            help="Seed that the map is made from; it names none of the numbered maps.",
            min=0,
            max=2**64 - 1,
        ),
    ] = 0,
    size: Annotated[int, typer.Option(help="Side of the map, m.", min=40, max=2000)] = 100,
    seed: Annotated[int, typer.Option(help="Seed of the match.", min=0, max=2**64 - 1)] = 0,
    robots: Annotated[
        int | None,
        typer.Option(help="Seats for robots. Default: in battle, up to six seats in all.", min=0, max=999),
    ] = None,
    time_limit: Annotated[float, typer.Option(help="Seconds of game time.", min=0.1, max=86_400)] = 60.0,
    record: Annotated[Path | None, typer.Option(help="Keep the match as a record in this file.")] = None,
    replay: Annotated[
        Path | None, typer.Option(help="Render the match as a Rerun recording into this file (.rrd).")
    ] = None,
    logs: Annotated[Path, typer.Option(help="Folder for what the agents print.")] = Path("out/play"),
    sandbox: InSandbox = None,
    as_json: AsJson = False,
) -> None:
    """Play one match, each agent in a sandbox of its own."""
    from wildscav_evaluator.cli.options.selection import check_plays, load_submissions, tracks_played
    from wildscav_evaluator.cli.sessions.play import make_spec, run_match

    check_folder("--logs", logs)
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
    )
    runs_in, loaded = chosen_sandbox(sandbox, loaded)
    try:
        run_match(spec, loaded, record=record, replay=replay, logs=logs, sandbox=runs_in, as_json=as_json)
    except OSError as error:
        raise UserError(describe(error)) from error
