"""``wildscav train``: train a policy, measure it, and make a submission of it."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from wildscav.cli.shared_options import AsJson, named_in
from wildscav.errors import INTERRUPTED, UserError
from wildscav_training.cli.track_and_level import known_track, level_names

if TYPE_CHECKING:
    from rich.table import Table

    from wildscav_training.learning.run import Report, Result
    from wildscav_training.learning.settings import TrainingSettings

MAX_SEEDS, MAX_EPISODES = 100, 10_000
SILENCE = 30.0  # s between two lines of progress where there is no terminal

Algorithm = Annotated[str, typer.Option(hidden=True)]  # there were several, once
Preset = Annotated[
    str,
    typer.Option(help="Hyperparameters and environment: tuned (learns in few steps) or paper (the paper's)."),
]
Level = Annotated[str | None, typer.Option(help="Random maps of this level.", **named_in(level_names))]
Map = Annotated[
    int | None, typer.Option("--map", help="A numbered map instead of random ones.", min=1, max=999)
]
Options = Annotated[
    list[str] | None,
    typer.Option(
        "--option", metavar="NAME=VALUE", help="An option of the environment, its value as JSON; repeatable."
    ),
]
Changes = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="NAME=VALUE", help="A hyperparameter to change, as JSON; repeatable."),
]
Stages = Annotated[
    str | None,
    typer.Option(
        "--curriculum",
        metavar="M,M,…",
        help="Start at most so many metres from the target, and farther away at 80 % success; last anywhere.",
    ),
]
Opponents = Annotated[
    str | None,
    typer.Option(
        metavar="NAME,…",
        help="Who fills the opponents' seats, drawn for each match: robots, submissions, and self for copies "
        "of the policy.",
    ),
]
OpponentSeats = Annotated[
    int | None, typer.Option(help="Opponents in a match; by default as many as the track has.", min=1, max=99)
]
EasyFirst = Annotated[
    bool,
    typer.Option("--easy-first", help="Robots among them begin at the level easy, and rise as they lose."),
]
StartFrom = Annotated[
    Path | None,
    typer.Option(
        help="Weights to start from: the policy.npz of another run with the same observations, actions and "
        "layers, or of a clone."
    ),
]
Steps = Annotated[int, typer.Option(help="Steps of all learners together.", min=1, max=10**12)]
Seed = Annotated[int, typer.Option(help="Seed of the first run.", min=0, max=2**20)]
Seeds = Annotated[int, typer.Option(help="Number of runs, each with a seed.", min=1, max=MAX_SEEDS)]
Workers = Annotated[int, typer.Option(help="Runs at the same time, each in a process.", min=1, max=MAX_SEEDS)]
Out = Annotated[Path, typer.Option("--out", "-o", help="Folder of the results; each run has a folder in it.")]
Resume = Annotated[bool, typer.Option("--resume", help="Continue what an interruption left in that folder.")]
Episodes = Annotated[int, typer.Option(help="Matches that each score is a mean of.", min=1, max=MAX_EPISODES)]
Submission = Annotated[
    Path | None,
    typer.Option(help="Folder to create: the first run's policy as a submission, which needs NumPy alone."),
]


def train(
    track: Annotated[str, typer.Option(help="Track to learn.")] = "navigation",
    algorithm: Algorithm = "ppo",
    preset: Preset = "tuned",
    level: Level = None,
    map_number: Map = None,
    option: Options = None,
    changes: Changes = None,
    curriculum: Stages = None,
    opponents: Opponents = None,
    opponent_seats: OpponentSeats = None,
    easy_first: EasyFirst = False,
    start_from: StartFrom = None,
    steps: Steps = 100_000,
    seed: Seed = 0,
    seeds: Seeds = 1,
    workers: Workers = 1,
    out: Out = Path("out/training"),
    resume: Resume = False,
    episodes: Episodes = 100,
    submission: Submission = None,
    as_json: AsJson = False,
) -> None:
    """Train a policy, measure it on maps of training and of testing, and make a submission of it.

    Each run learns on one processor core; it writes its figures for TensorBoard, and can be continued.

    With --json: `folder`, and `runs`: `seed`, `steps`, `cpu_seconds`, `wall_seconds` and `scores` of each,
    which have `split`, `choose`, `episodes` and `metrics`.
    """
    options = _environment(level, map_number, option)
    if algorithm != "ppo":
        raise UserError(
            f"--algorithm {algorithm} is gone: `wildscav train` learns by PPO; docs/training.md shows how "
            "Stable-Baselines3, RLlib and TorchRL train in the same environments",
            exit_code=2,
        )
    first = _settings(preset, track, options, changes, curriculum, steps, seed)
    first = _opposed(first, opponents, opponent_seats, easy_first=easy_first)
    if start_from is not None:
        from wildscav_training.learning.start import read_start

        first = replace(first, start=read_start(start_from))
    runs = [replace(first, seed=each) for each in range(seed, seed + seeds)]
    is_written = resume and submission is not None and _is_of(submission, runs[0])
    _check_folders(out, None if is_written else submission, resume=resume)

    def learned() -> None:
        if submission is not None and not is_written:
            _write_submission(out, runs[0], submission)

    try:
        results = _train_all(runs, out, episodes, min(workers, seeds), learned, resume=resume)
    except KeyboardInterrupt:
        raise UserError(
            f"interrupted: {out} keeps what is done; continue with --resume", INTERRUPTED
        ) from None
    from wildscav.terminal.console import console, print_json

    console.print(_table(results))
    if submission is not None:
        import shlex

        next_one = f"wildscav evaluate {shlex.quote(str(submission))} --track {track}"
        console.print(f"{submission} holds the policy as a submission. Next: {next_one}")
    if as_json:
        print_json({"folder": str(out), "runs": [result.as_json() for result in results]})


def _environment(level: str | None, map_number: int | None, option: list[str] | None) -> dict[str, Any]:
    """Return the options of the environment that were given."""
    from wildscav_training.cli.from_policy import read_option

    given = dict(map(read_option, option or []))
    if level is not None and map_number is not None:
        raise UserError("--level and --map are both given: train on random maps or on a numbered one", 2)
    for name, value in (("level", level), ("map", map_number)):
        if value is not None and given.setdefault(name, value) != value:
            raise UserError(f"--{name} and --option {name} differ", exit_code=2)
    return given


def _settings(
    preset: str,
    track: str,
    options: Mapping[str, Any],
    changes: list[str] | None,
    curriculum: str | None,
    steps: int,
    seed: int,
) -> "TrainingSettings":
    """Return the settings of a run."""
    from wildscav_engine.tracks import TRACKS
    from wildscav_training.cli.from_policy import read_option
    from wildscav_training.learning.settings import TrainingSettings, changed, preset_settings

    known_track(track)
    hyperparameters, all_options = preset_settings(preset, track, options)
    hyperparameters = changed(hyperparameters, dict(read_option(text, "--set") for text in changes or []))
    if curriculum is not None and not TRACKS[track].has_target:
        raise UserError(f"--curriculum is for tracks with a target, not for {track}", exit_code=2)
    stages = () if curriculum is None else _stages(curriculum)
    return TrainingSettings(track, all_options, steps, seed, hyperparameters, stages)


def _opposed(
    settings: "TrainingSettings", names: str | None, seats: int | None, *, easy_first: bool
) -> "TrainingSettings":
    """Return the settings of a run with its opponents."""
    from wildscav_training.learning.opposition import read_opposition

    if names is None:
        if seats is not None or easy_first:
            raise UserError("--opponent-seats and --easy-first are for runs with --opponents", exit_code=2)
        return settings
    if settings.options.get("opponents") is not None:
        raise UserError("--opponents and --option opponents=… are both given: take one", exit_code=2)
    found = read_opposition(names, settings.track, settings.options, seats, easy_first=easy_first)
    return replace(settings, opposition=found)


def _stages(text: str) -> tuple[float, ...]:
    """Return the start ranges of a curriculum, m."""
    try:
        stages = tuple(float(part) for part in text.split(","))
    except ValueError:
        stages = ()
    rises = all(before < after for before, after in zip((0.0, *stages), (*stages, 2000.5), strict=True))
    if not stages or not rises:
        raise UserError(
            f"--curriculum is {text!r}, must be metres that rise, at most 2000, such as 5,15,40", exit_code=2
        )
    return stages


def _check_folders(out: Path, submission: Path | None, *, resume: bool) -> None:
    """Refuse folders that are in use before anything is trained."""
    for name, path in (("--out", None if resume else out), ("--submission", submission)):
        if path is not None and path.exists() and (not path.is_dir() or any(path.iterdir())):
            hint = ", or continue with --resume" if name == "--out" and path.is_dir() else ""
            raise UserError(f"{name}: {path} is not an empty folder; name another{hint}", exit_code=2)


def _is_of(submission: Path, settings: "TrainingSettings") -> bool:
    """Whether a run with these settings has already written its submission into a folder."""
    from wildscav_training.learning.submission import TRAINING, training_file

    path = submission / TRAINING  # written last
    return path.is_file() and path.read_bytes() == training_file(settings)


def _train_all(
    runs: "list[TrainingSettings]",
    out: Path,
    episodes: int,
    workers: int,
    learned: Callable[[], None],
    *,
    resume: bool,
) -> "list[Result]":
    """Train and measure; ``learned`` is called when the first run's weights are written."""
    from rich.progress import TextColumn, TimeRemainingColumn

    from wildscav.terminal.console import error_console, progress_bar
    from wildscav_engine.compilation.engine_progress import preparing
    from wildscav_training.learning.run import train as train_one

    columns = TimeRemainingColumn(), TextColumn("{task.fields[figures]}")
    given: dict[str, Any] = {"resume": resume, "episodes": episodes}
    folders = [out / f"seed-{settings.seed}" for settings in runs]
    with preparing(error_console), progress_bar(*columns) as progress:
        reports = [
            _reporter(
                progress,
                progress.add_task(f"seed {one.seed}", total=one.steps, figures=""),
                one,
                learned if one is runs[0] else lambda: None,
            )
            for one in runs
        ]
        if workers == 1:
            each = zip(runs, folders, reports, strict=True)
            return [train_one(settings, folder, report, **given) for settings, folder, report in each]
        from wildscav_training.learning.at_once import train_at_once

        named = list(zip(runs, folders, strict=True))
        return train_at_once(
            named, lambda place, figures: reports[place](figures), processes=workers, **given
        )


def _reporter(
    progress: Any, task: Any, settings: "TrainingSettings", learned: Callable[[], None]
) -> "Report":
    """Return what shows the figures of a run: a bar in a terminal, else a line now and then."""
    import time

    from wildscav_training.learning.evaluation import WAYS

    said = time.monotonic()

    def report(figures: Mapping[str, float]) -> None:
        nonlocal said
        news, shown = "", ""
        if "continued" in figures:
            news = f"continues from step {int(figures['continued']):,}"
            progress.update(task, completed=figures["continued"])
        elif "measured" in figures:
            done, total = int(figures["measured"]), int(figures["to_measure"])
            shown = f"{done:,} of {total:,} matches are measured"
            if done == 0:
                learned()
                news = f"learned; measuring {len(WAYS)} × {total // len(WAYS)} matches"
                progress.reset(task, total=total)
            progress.update(task, completed=done, figures=shown)
        else:
            shown = _shown(figures)
            progress.update(task, completed=figures["steps"], figures=shown)
        if news or (not progress.console.is_terminal and time.monotonic() - said > SILENCE):
            progress.console.print(f"seed {settings.seed}: {news or shown}")
            said = time.monotonic()

    return report


def _shown(figures: Mapping[str, float]) -> str:
    """Return figures of an iteration in one line."""
    names = {"return": "return", "success": "success in training", "supplies": "supplies"}
    parts = [f"{int(figures['steps']):,} steps", f"{figures['cpu_seconds']:.0f} CPU s"]
    parts += [f"{title} {figures[name]:.2f}" for name, title in names.items() if name in figures]
    stage = int(figures["stage"])
    return ", ".join(parts + ([f"stage {stage + 1}"] if stage else []))


def _table(results: "list[Result]") -> "Table":
    """Return a table with a row for each run: what it took, and the first metric that says how good it is."""
    from wildscav.terminal.tables import FittingTable

    metrics = results[0].scores[0].metrics
    metric = "success" if "success" in metrics else next(iter(metrics))
    table = FittingTable(
        f"{metric}, means of {results[0].scores[0].episodes} episodes; times of learning alone"
    )
    for title in ("seed", "steps", "CPU s", "wall s"):
        table.add_column(title, justify="right", no_wrap=True)
    for score in results[0].scores:
        table.add_column(f"{score.split}\n{score.choose}", justify="right", no_wrap=True)
    for result in results:
        took = (
            str(result.seed),
            f"{result.steps:,}",
            f"{result.cpu_seconds:.0f}",
            f"{result.wall_seconds:.0f}",
        )
        table.add_row(*took, *(f"{score.metrics[metric]:.2f}" for score in result.scores))
    return table


def _write_submission(out: Path, settings: "TrainingSettings", folder: Path) -> None:
    """Write the policy of a run as a submission."""
    from wildscav.cli.init import submission_name, write_files
    from wildscav.policy.networks import Choose
    from wildscav_training.learning.submission import policy_submission

    name = submission_name(folder.resolve().name)
    write_files(folder, policy_submission(out / f"seed-{settings.seed}", settings, name, Choose.SAMPLED))
