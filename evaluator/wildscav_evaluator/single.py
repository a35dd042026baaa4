"""A single match for ``wildscav play``: its spec, its progress, its table and its files."""

import asyncio
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from rich import box
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn
from rich.table import Table
from rich.text import Text

from wildscav.console import command, console
from wildscav.errors import UserError
from wildscav.server import HostedMatch
from wildscav_engine.record import SUFFIX, read_record, write_record
from wildscav_engine.spec import SUBMISSION, MapConfig, MapSpec, MatchSpec
from wildscav_evaluator.conduct import remark
from wildscav_evaluator.jobs import FINISHED
from wildscav_evaluator.play import Played, Seating, play_match, prepare_logs, remove_empty_logs
from wildscav_evaluator.run import metric_infos
from wildscav_evaluator.seating import BATTLE_ROBOTS
from wildscav_evaluator.submission import Submission
from wildscav_evaluator.tables import add_columns, heading, number
from wildscav_evaluator.warm import warm

if TYPE_CHECKING:
    from wildscav_engine.result import SeatResult

BATTLE_SEATS = 6  # unless asked otherwise
HOUSE_AREA = 2500.0  # m² of map for each house


def make_spec(
    track: str,
    *,
    submissions: int,
    robots: int | None,
    map_seed: int,
    size: int,
    seed: int,
    time_limit: float,
) -> MatchSpec:
    """Return the spec of a match; the submissions have the first seats, robots the others.

    Raises:
        UserError: The map's size is odd.
    """
    if size % 2:
        raise UserError(f"--size is {size}, must be even", exit_code=2)
    if robots is None:
        robots = max(0, BATTLE_SEATS - submissions) if track == "battle" else 0
    filled_by = [BATTLE_ROBOTS[number % len(BATTLE_ROBOTS)] for number in range(robots)]
    houses = max(1, min(200, round(size * size / HOUSE_AREA)))
    return MatchSpec(
        track=track,
        map=MapSpec(config=MapConfig(size=size, houses=houses), seed=map_seed),
        seed=seed,
        seats=(SUBMISSION,) * submissions + tuple(filled_by),
        time_limit=time_limit,
    )


def play_single(
    spec: MatchSpec,
    submissions: Sequence[Submission],
    *,
    record: Path | None,
    replay: Path | None,
    logs: Path,
) -> None:
    """Play a match, show how it went, and write what is asked for.

    Raises:
        UserError: An agent failed; everything else was shown and written.
        OSError: A file could not be written.
    """
    paths = tuple(logs / f"{seat}-{submission.name}.log" for seat, submission in enumerate(submissions))
    prepare_logs(paths)
    seating = Seating(spec, tuple(submissions), paths)
    with console.status("preparing the engine (the first run compiles it, which takes about a minute)"):
        warm()
    played = asyncio.run(_play_with_progress(seating))
    console.print(_table(seating, played))
    _remark(seating, played)
    _write(played, seating, record, replay)
    remove_empty_logs(paths)
    if any(path.exists() for path in paths):
        console.print(f"what the agents printed is in {logs}", soft_wrap=True)
    _complain(played, seating)


async def _play_with_progress(seating: Seating) -> Played:
    spec = seating.spec
    columns = (TextColumn("{task.description}"), BarColumn(), TimeElapsedColumn())
    with Progress(*columns, console=console, transient=True) as progress:
        task = progress.add_task(f"{spec.track}, {spec.time_limit:g} s", total=spec.frame_limit)
        watching: list[asyncio.Task[None]] = []

        async def watch(hosted: HostedMatch) -> None:
            while True:
                progress.update(task, completed=hosted.match.frame)
                await asyncio.sleep(0.2)

        try:
            return await play_match(
                seating, started=lambda hosted: watching.append(asyncio.create_task(watch(hosted)))
            )
        finally:
            for watcher in watching:
                watcher.cancel()


def _table(seating: Seating, played: Played) -> Table:
    result = played.match.result()
    metrics = metric_infos(seating.spec.track)
    seconds = result.frames / 50
    title = f"{seating.spec.track} · map {seating.spec.map.seed} · seed {seating.spec.seed} · {seconds:g} s"
    table = Table(title=title, title_justify="left", title_style="bold", box=box.SIMPLE_HEAD)
    add_columns(table, "seat")
    table.add_column("name", vertical="bottom")
    add_columns(table, *map(heading, metrics))
    table.add_column("agent", vertical="bottom")

    def key(seat: "SeatResult") -> float:
        value = seat.metrics[metrics[0].name]
        return value if metrics[0].lower_is_better else -value

    for seat in sorted(result.seats, key=key):
        values = [number(seat.metrics[metric.name], metric) for metric in metrics]
        report = played.seats.get(seat.seat)
        table.add_row(str(seat.seat), seating.names[seat.seat], *values, report.status if report else "robot")
    return table


def _remark(seating: Seating, played: Played) -> None:
    """Say which agents' actions were not as they must be."""
    for seat, report in played.seats.items():
        line = remark(seating.names[seat], actions=report.steps_played, invalid=report.invalid_actions)
        if line is not None:
            console.print(Text.assemble(("note: ", "yellow"), line))


def _write(played: Played, seating: Seating, record: Path | None, replay: Path | None) -> None:
    if record is None and replay is None:
        return
    with tempfile.TemporaryDirectory() as folder:
        path = record or Path(folder) / f"match{SUFFIX}"
        path.parent.mkdir(parents=True, exist_ok=True)
        write_record(path, played.match, seating.names)
        if record is not None:
            console.print(f"record: {record}", soft_wrap=True)
        if replay is not None:
            from wildscav_engine.view import write_replay

            replay.parent.mkdir(parents=True, exist_ok=True)
            with console.status("rendering the replay"):
                write_replay(read_record(path), replay, follow=seating.seats[0])
            console.print(f"replay: {replay}\n  {command('rerun')} {replay}", soft_wrap=True)


def _complain(played: Played, seating: Seating) -> None:
    failures = []
    for seat, log in zip(seating.seats, seating.logs, strict=True):
        report = played.seats[seat]
        if report.status != FINISHED:
            see = f" (its log: {log})" if log.exists() else ""
            failures.append(f"{seating.names[seat]} {report.status.value}: {report.detail}{see}")
    if failures:
        raise UserError("; ".join(failures))
