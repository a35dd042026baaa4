"""``wildscav baselines``: how strong the baselines, and agents beside them, are on the levels."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Annotated, Any

import typer

from wildscav.cli.shared_options import AsJson, named_in
from wildscav.errors import UserError
from wildscav_training.cli.level_option import level_names

if TYPE_CHECKING:
    from rich.table import Table

    from wildscav_training.trials import Trial

    Played = dict[tuple[str, str], list[Trial]]  # by level and agent

ALL = "all"
MAX_MATCHES = 10_000


def _tracks() -> Sequence[str]:
    from wildscav_engine.tracks import TRACKS

    return tuple(TRACKS)


def _levels() -> Sequence[str]:
    return (*level_names(), ALL)


def baselines(
    agents: Annotated[
        list[str] | None,
        typer.Argument(
            help="Baselines, submissions' folders, oracle (knows the map) or straight (walks straight to the "
            "target). Default: all baselines of the track. Their code is trusted.",
            metavar="[AGENT]…",
            show_default=False,
        ),
    ] = None,
    track: Annotated[str, typer.Option(help="Track to play.", **named_in(_tracks))] = "navigation",
    level: Annotated[
        str, typer.Option(help="The level whose test maps are played, or all.", **named_in(_levels))
    ] = "hard",
    matches: Annotated[
        int, typer.Option(help="Matches of each agent on a level, each on a map.", min=2, max=MAX_MATCHES)
    ] = 100,
    as_json: AsJson = False,
) -> None:
    """Let the baselines play on the test maps of a level, in this process, and show what they reach.

    All agents play the same matches; each has the first seat, and robots have the others. In gathering and
    battle, these robots make the level, on maps of one kind.
    """
    from wildscav.terminal.console import console, print_json

    names = agents or _baselines_of(track)
    levels = level_names() if level == ALL else (level,)
    played = _play(track, levels, names, matches)
    console.print(_table(track, matches, played))
    if as_json:
        print_json({"track": track, "matches": matches, "rows": _rows(played)})


def _baselines_of(track: str) -> list[str]:
    """Return the names of the baselines that play a track, between those that know the target."""
    from wildscav.baselines import NAMES, baseline_folder
    from wildscav.sdk.submission_folder import MANIFEST
    from wildscav_engine.tracks import TRACKS
    from wildscav_server.hosting.manifest import read_manifest

    names = [name for name in NAMES if track in read_manifest(baseline_folder(name) / MANIFEST).tracks]
    return ["straight", *names, "oracle"] if TRACKS[track].has_target else names


def _play(track: str, levels: Sequence[Any], names: Sequence[str], matches: int) -> "Played":
    """Play all matches.

    Raises:
        UserError: There is no such agent, or it does not play the track.
    """
    from wildscav.terminal.console import error_console, progress_bar
    from wildscav_engine.compilation.engine_progress import preparing
    from wildscav_training.opponents import named_agent
    from wildscav_training.trials import matches_on, play

    players = {name: named_agent(name) for name in names}
    for player in players.values():
        try:
            player.check(track)
        except ValueError as error:
            raise UserError(str(error), exit_code=2) from None
    played: Played = {(level, name): [] for level in levels for name in players}
    with preparing(error_console), progress_bar() as progress:
        task = progress.add_task("", total=len(played) * matches)
        for level in levels:
            for spec in matches_on(track, level, matches):
                for name, player in players.items():
                    progress.update(task, description=f"{level}, {name}")
                    played[level, name].append(play(player, spec))
                    progress.advance(task)
    return played


def _table(track: str, matches: int, played: "Played") -> "Table":
    """Return a row for each agent on each level: success and SPL, or else the track's score."""
    from wildscav.terminal.tables import FittingTable
    from wildscav_engine.tracks import TRACKS
    from wildscav_training.trials import SUCCESS, mean, rate

    shown = (SUCCESS, "spl") if TRACKS[track].has_target else (TRACKS[track].metrics[0].name,)
    table = FittingTable(f"{track}, {matches} matches on test maps, with 95 % intervals")
    for title in ("level", "agent"):
        table.add_column(title, no_wrap=True)
    for name in (*shown, "ms a step"):
        table.add_column("SPL" if name == "spl" else name, justify="right", no_wrap=True)
    for (level, agent), trials in played.items():
        values = ([trial.metrics[name] for trial in trials] for name in shown)
        cells = [(rate if name == SUCCESS else mean)(each) for name, each in zip(shown, values, strict=True)]
        table.add_row(level, agent, *cells, f"{_milliseconds(trials):.1f}")
    return table


def _rows(played: "Played") -> list[dict[str, Any]]:
    """Return the figures for JSON."""
    from wildscav_training.trials import estimate

    return [
        {
            "level": level,
            "agent": agent,
            "milliseconds": round(_milliseconds(trials), 3),
            "metrics": {name: estimate(name, trials)._asdict() for name in trials[0].metrics},
        }
        for (level, agent), trials in played.items()
    ]


def _milliseconds(trials: "Sequence[Trial]") -> float:
    """Return the mean processor time for a step, ms."""
    from statistics import fmean

    return 1000.0 * fmean(trial.act_time for trial in trials)
