"""The command ``wildscav tournament``."""

from typing import Annotated, Literal

import typer

from wildscav.cli.shared_options import takes
from wildscav_evaluator.bounds import MAX_ROUNDS
from wildscav_evaluator.cli.options.evaluation import NoDatabase, PlayOptions


@takes(PlayOptions)
def tournament(
    options: PlayOptions,
    entrants: Annotated[
        list[str],
        typer.Argument(
            help="Two or more submissions: folders, archives, image:NAME or baselines. robot:NAME enters one "
            "of the robots.",
            metavar="ENTRANT",
            show_default=False,
        ),
    ],
    track: Annotated[
        str, typer.Option(help="The track to play: battle, royale, gathering, capture or navigation.")
    ],
    rounds: Annotated[
        int,
        typer.Option(
            help="How many rounds to play. After each, every entrant has played equally often. In fewer "
            "than 6 games, no two entrants can be told apart.",
            min=1,
            max=MAX_ROUNDS,
        ),
    ] = 6,
    seats: Annotated[
        int | None,
        typer.Option(
            help="Seats of entrants in a match. Default: as many as the suite's matches have, or fewer if "
            "there are fewer entrants.",
            min=2,
            max=1000,
            show_default=False,
        ),
    ] = None,
    team_size: Annotated[
        int | None,
        typer.Option(
            help="Seats of a team, all filled by one entrant. Default: 2 on capture, otherwise 1.",
            min=1,
            max=500,
            show_default=False,
        ),
    ] = None,
    mixed: Annotated[
        bool, typer.Option("--mixed", help="Fill the seats of a team with different entrants.")
    ] = False,
    repeats: Annotated[
        int | None,
        typer.Option(
            help="How often each map and match seed is played, each time in other seats. Default: 2.",
            min=1,
            show_default=False,
        ),
    ] = None,
    robots: Annotated[
        str | None,
        typer.Option(
            help="Robots in further seats, which are not rated: how many, or which, such as "
            "fighter,gatherer-hard. Default: none.",
            show_default=False,
        ),
    ] = None,
    meet_own: Annotated[
        bool, typer.Option("--meet-own", help="Let several entries of one submission meet.")
    ] = False,
    replays: Annotated[
        Literal["none", "first", "all"],
        typer.Option(help="Which matches to render as Rerun recordings."),
    ] = "first",
    db: NoDatabase = None,  # noqa: ARG001 - its callback says what replaced it
) -> None:
    """Let submissions play each other, and rate them by their places.

    Everyone plays equally often, and each map is played again with the seats exchanged. The same command
    continues a tournament that was interrupted; the order of the entrants does not matter.
    """
    from wildscav_evaluator.cli.options.selection import check_suite_has, check_track
    from wildscav_evaluator.cli.options.tournament import (
        chosen_settings,
        load_entrants,
        most_entries,
    )
    from wildscav_evaluator.cli.sessions.tournament import run_tournament
    from wildscav_evaluator.output.numbered_folders import TOURNAMENTS
    from wildscav_evaluator.plans.tournament import TournamentPlan
    from wildscav_evaluator.suites.suite_file import find_suite

    chosen = find_suite(options.suite)
    check_track(track)
    check_suite_has(chosen, track)
    loaded, playing_robots = load_entrants(entrants, track, meet_own=meet_own)
    settings = chosen_settings(
        len(loaded) + len(playing_robots),
        most_entries(loaded),
        chosen,
        track,
        seats=seats,
        team_size=team_size,
        mixed=mixed,
        repeats=repeats,
        robots=robots,
        meet_own=meet_own,
    )
    with options.planned(
        TournamentPlan,
        loaded,
        TOURNAMENTS,
        suite=chosen,
        robots=playing_robots,
        track=track,
        settings=settings,
        rounds=rounds,
        replays=replays,
    ) as (plan, machines):
        run_tournament(plan, options.monitor, machines, as_json=options.as_json)
