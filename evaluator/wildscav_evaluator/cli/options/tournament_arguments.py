"""The arguments and options of ``wildscav tournament`` alone.

The command line imports this module to show its help, so it imports nothing heavy.
"""

from typing import Annotated, Literal

import typer

from wildscav_evaluator.bounds import MOST_ROUNDS

Entrants = Annotated[
    list[str],
    typer.Argument(
        help="Two or more submissions: folders, archives, image:NAME or baselines. robot:NAME enters one "
        "of the robots.",
        metavar="ENTRANT",
        show_default=False,
    ),
]
TrackOption = Annotated[
    str, typer.Option(help="The track to play: battle, royale, gathering, capture or navigation.")
]
RoundsOption = Annotated[
    int,
    typer.Option(
        help="How many rounds to play. After each, every entrant has played equally often. In fewer "
        "than 6 games, no two entrants can be told apart.",
        min=1,
        max=MOST_ROUNDS,
    ),
]
SeatsOption = Annotated[
    int | None,
    typer.Option(
        help="Seats of entrants in a match. Default: as many as the suite's matches have, or fewer if "
        "there are fewer entrants.",
        min=2,
        max=1000,
        show_default=False,
    ),
]
TeamSizeOption = Annotated[
    int | None,
    typer.Option(
        help="Seats of a team, all filled by one entrant. Default: 2 on capture, otherwise 1.",
        min=1,
        max=500,
        show_default=False,
    ),
]
MixedOption = Annotated[
    bool, typer.Option("--mixed", help="Fill the seats of a team with different entrants.")
]
RepeatsOption = Annotated[
    int | None,
    typer.Option(
        help="How often each map and match seed is played, each time in other seats. Default: 2.",
        min=1,
        show_default=False,
    ),
]
RobotsOption = Annotated[
    str | None,
    typer.Option(
        help="Robots in further seats, which are not rated: how many, or which, such as "
        "fighter,gatherer-hard. Default: none.",
        show_default=False,
    ),
]
MeetOwnOption = Annotated[
    bool, typer.Option("--meet-own", help="Let several entries of one submission meet.")
]
ReplaysOption = Annotated[
    Literal["none", "first", "all"],
    typer.Option(help="Which matches to render as Rerun recordings."),
]
