"""The arguments and options that several of ``evaluate``, ``compare``, ``tournament`` and ``play`` have.

The command line imports this module to show its help, so it imports nothing heavy.
"""

from pathlib import Path
from typing import Annotated, Literal

import typer

Submissions = Annotated[
    list[Path],
    typer.Argument(
        help="Folders with a submission.toml, archives of such folders, image:NAME, or the baselines random, "
        "homing, hunter, scavenger, commando, survivor, navigator, mapper, learned-navigator, "
        "learned-scavenger, learned-commando and cloned-navigator.",
        metavar="SUBMISSION",
        show_default=False,
    ),
]

SuiteOption = Annotated[
    str,
    typer.Option(
        help="Which matches to play. quick: 3 to 5 short ones per track, on small maps. official: the "
        "competition's, on large maps (100 of navigation, gathering and capture, 10 of battle and royale). "
        "wild: mazes that must be seen to be crossed (100 of navigation and capture), and agents that meet "
        "at a rich hot spot (20 of gathering, battle and royale). Or the file of your own suite (.toml)."
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
        help="Output folder. Default: a new folder with the next number, or the one in which the same "
        "command was interrupted.",
        show_default=False,
    ),
]
FreshOption = Annotated[
    bool,
    typer.Option(
        "--fresh",
        help="Play everything again: into a new folder or, with --out, replacing what that folder holds.",
        show_default=False,
    ),
]
JobsOption = Annotated[
    int | None,
    typer.Option(help="Matches at once. Default: one per processor core.", min=1, show_default=False),
]

LogOption = Annotated[
    Literal["json", "text"] | None,
    typer.Option(
        help="Write log lines in this format to stderr instead of showing a dashboard.", show_default=False
    ),
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
DatabaseOption = Annotated[Path, typer.Option(help="The leaderboard's database.")]
