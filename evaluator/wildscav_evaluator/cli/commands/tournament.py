"""The command ``wildscav tournament``."""

from typing import Annotated, Literal

import typer

from wildscav.cli.shared_options import takes
from wildscav_evaluator.cli.options.evaluation import NoDatabase, TournamentOptions


@takes(TournamentOptions)
def tournament(
    options: TournamentOptions,
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
    replays: Annotated[
        Literal["none", "first", "all"],
        typer.Option(help="Which matches to render as Rerun recordings."),
    ] = "first",
    db: NoDatabase = None,  # noqa: ARG001 - its callback says what replaced it
) -> None:
    """Let submissions play each other, and rate them by their places.

    Everyone plays equally often, and each map is played again with the seats exchanged. The same command
    continues a tournament that was interrupted; the order of the entrants does not matter.

    With --json: `folder`, `tournament` (as in tournament.json) and `results` (as in results.json).
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

    chosen = options.find_suite()
    check_track(track)
    check_suite_has(chosen, track)
    loaded, playing_robots = load_entrants(entrants, track, meet_own=options.meet_own)
    entrants_count = len(loaded) + len(playing_robots)
    settings = chosen_settings(options, entrants_count, most_entries(loaded), chosen, track)
    with options.planned(
        TournamentPlan,
        loaded,
        TOURNAMENTS,
        suite=chosen,
        robots=playing_robots,
        track=track,
        settings=settings,
        rounds=options.rounds,
        replays=replays,
    ) as (plan, machines):
        run_tournament(plan, options.monitor, machines, as_json=options.as_json)
