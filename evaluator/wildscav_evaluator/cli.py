"""The commands ``wildscav play`` and ``wildscav evaluate``.

The command line imports this to show its help: what is heavy is imported when a command runs.
"""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from wildscav.errors import UserError, describe

if TYPE_CHECKING:
    from wildscav_evaluator.seeds import SuiteSeed
    from wildscav_evaluator.submission import Submission
    from wildscav_evaluator.suites import Suite

Submissions = Annotated[
    list[Path],
    typer.Argument(help="Folders with a submission.toml.", metavar="SUBMISSION", show_default=False),
]

SuiteOption = Annotated[
    str,
    typer.Option(
        help="Which matches. quick: 5 of navigation, 4 of gathering, 3 of battle, small and short. "
        "official: the competition's 100, 100 and 10 on large maps. Or an own suite's file (.toml)."
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
JobsOption = Annotated[
    int | None,
    typer.Option(help="Matches at once. Default: one a processor core.", min=1, show_default=False),
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
    out: Annotated[
        Path,
        typer.Option(help="Output folder. The same command goes on with an evaluation that was broken off."),
    ] = Path("out/evaluation"),
    fresh: Annotated[
        bool, typer.Option("--fresh", help="Begin anew: remove the evaluation in the output folder.")
    ] = False,
    db: Annotated[Path, typer.Option(help="The leaderboard's database.")] = Path("out/wildscav.db"),
) -> None:
    """Evaluate submissions on seeded suites of matches, each agent in a process of its own."""
    from wildscav_evaluator.own_suite import find_suite
    from wildscav_evaluator.run import Plan, default_jobs
    from wildscav_evaluator.session import run_session

    loaded, chosen = _load(submissions), find_suite(suite)
    plan = Plan(
        submissions=loaded,
        tracks=suite_tracks(loaded, track or [], chosen),
        suite=chosen,
        seed=suite_seed(seed, secret),
        replays=replays,
        jobs=jobs or default_jobs(),
        out=out,
        fresh=fresh,
    )
    run_session(plan, db)


def play(
    submissions: Submissions,
    track: Annotated[
        str | None, typer.Option(help="What to play. Default: the first submission's first track.")
    ] = None,
    map_seed: Annotated[int, typer.Option("--map", help="Seed of the map.", min=0, max=2**64 - 1)] = 0,
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
) -> None:
    """Play one match, each agent in a process of its own."""
    from wildscav_evaluator import single

    loaded = _load(submissions)
    chosen = _tracks(loaded, [track] if track else list(loaded[0].manifest.tracks[:1]))[0]
    for submission in loaded:
        _check_plays(submission, chosen)
    spec = single.make_spec(
        chosen,
        submissions=len(loaded),
        robots=robots,
        map_seed=map_seed,
        size=size,
        seed=seed,
        time_limit=time_limit,
    )
    try:
        single.play_single(spec, loaded, record=record, replay=replay, logs=logs)
    except OSError as error:
        raise UserError(describe(error)) from error


def _load(folders: list[Path]) -> "tuple[Submission, ...]":
    from wildscav_evaluator.submission import load_submission

    return tuple(load_submission(folder) for folder in folders)


def _tracks(submissions: "tuple[Submission, ...]", asked: list[str]) -> tuple[str, ...]:
    """Return the tracks to play, in the order of the registry.

    Raises:
        UserError: There is no such track, or a submission plays none of them.
    """
    from wildscav_engine.tracks import TRACKS

    for name in asked:
        if name not in TRACKS:
            raise UserError(f"there is no track {name!r}; the tracks are {', '.join(TRACKS)}", exit_code=2)
    wanted = [name for name in TRACKS if not asked or name in asked]
    for submission in submissions:
        if not set(wanted) & set(submission.manifest.tracks):
            _check_plays(submission, wanted[0])
    return tuple(
        name for name in wanted if any(name in submission.manifest.tracks for submission in submissions)
    )


def suite_tracks(submissions: "tuple[Submission, ...]", asked: list[str], suite: "Suite") -> tuple[str, ...]:
    """Return the tracks of a suite that are to be played.

    Raises:
        UserError: The suite has not a track that is asked for, or none that the submissions play.
    """
    tracks = _tracks(submissions, asked)
    for name in tracks if asked else ():
        if name not in suite.courses:
            raise UserError(
                f"suite {suite.name} has no {name}; its tracks are {', '.join(suite.courses)}", exit_code=2
            )
    played = tuple(name for name in tracks if name in suite.courses)
    for submission in submissions:
        if not set(played) & set(submission.manifest.tracks):
            raise UserError(
                f"submission {submission.name!r} plays no track of suite {suite.name}, which has "
                f"{', '.join(suite.courses)}",
                exit_code=2,
            )
    return played


def suite_seed(seed: int | None, secret: Path | None) -> "SuiteSeed":
    """Return the seed that is asked for.

    Raises:
        UserError: Both kinds are, or there is no such secret.
    """
    from wildscav_evaluator.seeds import SuiteSeed, read_secret

    if secret is None:
        return SuiteSeed(seed or 0)
    if seed is not None:
        raise UserError("--seed and --secret are given: the seed is public or hidden, not both", exit_code=2)
    return read_secret(secret)


def _check_plays(submission: "Submission", track: str) -> None:
    if track not in submission.manifest.tracks:
        raise UserError(
            f"submission {submission.name!r} does not play {track}: the tracks in "
            f"{submission.folder / 'submission.toml'} are {', '.join(submission.manifest.tracks)}",
            exit_code=2,
        )
