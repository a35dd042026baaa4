"""``wildscav baselines``: how strong the baselines, and agents beside them, are on the levels."""

from collections.abc import Sequence
from functools import partial
from typing import TYPE_CHECKING, Annotated, Any

import typer

from wildscav.cli.shared_options import AsJson, named_in
from wildscav.errors import UserError
from wildscav_training.cli.playing import ALL, baselines_of, play_all, players_of
from wildscav_training.cli.track_and_level import level_names

if TYPE_CHECKING:
    from rich.table import Table

    from wildscav_training.cli.playing import Played
    from wildscav_training.trials import Trial

MAX_MATCHES = 10_000
LEVEL_MATCHES, SCENARIO_MATCHES = 100, 20  # by default
DIGITS = {"score": 0, "random": 0, "reference": 0, "normalized": 2}  # of what is shown of scenarios


def _tracks() -> Sequence[str]:
    from wildscav_engine.tracks import TRACKS

    return tuple(TRACKS)


def _levels() -> Sequence[str]:
    return (*level_names(), ALL)


def _scenarios() -> Sequence[str]:
    from wildscav_training.company.scenarios import SCENARIOS

    return (*SCENARIOS, ALL)


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
    track: Annotated[
        str | None,
        typer.Option(
            help="Track to play. Default: navigation, or all of the scenarios.", **named_in(_tracks)
        ),
    ] = None,
    level: Annotated[
        str | None,
        typer.Option(
            help="The level whose test maps are played, or all. Default: hard.", **named_in(_levels)
        ),
    ] = None,
    scenario: Annotated[
        str | None,
        typer.Option(
            help="In place of a level, a scenario of held-out company, or all.", **named_in(_scenarios)
        ),
    ] = None,
    matches: Annotated[
        int | None,
        typer.Option(
            help="Matches of each agent, each on a map. Default: 100 on a level, 20 in a scenario.",
            min=2,
            max=MAX_MATCHES,
        ),
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Let the baselines play on the test maps of a level, in this process, and show what they reach.

    All agents play the same matches; each has the first seat, and robots have the others. In gathering and
    battle, these robots make the level, on maps of one kind. In a scenario, others have the seats whom
    nothing else draws, and normalized scores are 0 for random and 1 for commando, the reference.

    With --json: `track`, `matches`, and `rows`: `level` or `scenario`, `agent`, `milliseconds` (a step), and
    `metrics`: by name, `mean`, `low` and `high` of its 95 % interval.
    """
    from wildscav.terminal.console import console, print_json
    from wildscav_training.cli.scenarios import play_scenarios

    if scenario is not None:
        if level is not None:
            raise UserError("--scenario has maps of its own; omit --level", exit_code=2)
        place, shown, matches = "scenario", tuple(DIGITS), matches or SCENARIO_MATCHES
        played = play_scenarios(scenario, track, agents, matches)
    else:
        place, track, matches = "level", track or "navigation", matches or LEVEL_MATCHES
        levels = level_names() if level == ALL else (level or "hard",)
        shown = _shown(track)
        played = _play(track, levels, agents or baselines_of(track), matches)
    title = f"{track or 'held-out company'}, {matches} matches on test maps, with 95 % intervals"
    console.print(_table(title, place, shown, played))
    if as_json:
        print_json({"track": track, "matches": matches, "rows": _rows(place, played)})


def _play(track: str, levels: Sequence[Any], names: Sequence[str], matches: int) -> "Played":
    """Play all matches."""
    from wildscav_training.trials import matches_on, play

    players = players_of((track,), names)
    each = (
        ((level, name), partial(play, player, spec))
        for level in levels
        for spec in matches_on(track, level, matches)
        for name, player in players.items()
    )
    return play_all(each, len(levels) * len(players) * matches)


def _shown(track: str) -> tuple[str, ...]:
    """Return the metrics of a track in the table: success and SPL, or else its score."""
    from wildscav_engine.tracks import TRACKS
    from wildscav_training.trials import SUCCESS

    return (SUCCESS, "spl") if TRACKS[track].has_target else (TRACKS[track].metrics[0].name,)


def _table(title: str, place: str, shown: Sequence[str], played: "Played") -> "Table":
    """Return a row for each agent on each level or in each scenario."""
    from wildscav.terminal.tables import FittingTable

    table = FittingTable(title)
    for head in (place, "agent"):
        table.add_column(head, no_wrap=True)
    for name in (*shown, "ms a step"):
        table.add_column("SPL" if name == "spl" else name, justify="right", no_wrap=True)
    for (where, agent), trials in played.items():
        cells = [
            _cell(name, [trial.metrics[name] for trial in trials if name in trial.metrics]) for name in shown
        ]
        table.add_row(where, agent, *cells, f"{_milliseconds(trials):.1f}" if trials else "")
    return table


def _cell(name: str, values: Sequence[float]) -> str:
    """Return a metric with its interval; a dash if there is none."""
    from wildscav_training.trials import SUCCESS, mean, rate

    if not values:
        return "–"
    if name == SUCCESS:
        return rate(values)
    return mean(values, digits=DIGITS.get(name, 3 if name == "spl" else 1))


def _rows(place: str, played: "Played") -> list[dict[str, Any]]:
    """Return the figures for JSON."""
    from wildscav_training.trials import estimate

    return [
        {
            place: where,
            "agent": agent,
            "milliseconds": round(_milliseconds(trials), 3),
            "metrics": {name: estimate(name, trials)._asdict() for name in trials[0].metrics},
        }
        for (where, agent), trials in played.items()
        if trials
    ]


def _milliseconds(trials: "Sequence[Trial]") -> float:
    """Return the mean processor time for a step, ms."""
    from statistics import fmean

    return 1000.0 * fmean(trial.act_time for trial in trials)
