"""The command ``wildscav tournament``."""

from pathlib import Path
from typing import Annotated, Literal

import typer

from wildscav.cli.json_option import AsJson
from wildscav_evaluator.bounds import MOST_ROUNDS
from wildscav_evaluator.cli.options.evaluation import (
    FreshOption,
    JobsOption,
    LogOption,
    MetricsOption,
    OutOption,
    SecretOption,
    SeedOption,
    SuiteOption,
)
from wildscav_evaluator.cli.options.executor import AddressOption, ExecutorOption, executor_of
from wildscav_evaluator.cli.options.sandbox import InSandbox, chosen_sandbox
from wildscav_evaluator.cli.options.signing import SignOption, signing_key, warn_of_open_key


def tournament(
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
    suite: SuiteOption = "quick",
    rounds: Annotated[
        int,
        typer.Option(
            help="How many rounds to play. After each, every entrant has played equally often. In fewer "
            "than 6 games, no two entrants can be told apart.",
            min=1,
            max=MOST_ROUNDS,
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
    seed: SeedOption = None,
    secret: SecretOption = None,
    jobs: JobsOption = None,
    replays: Annotated[
        Literal["none", "first", "all"],
        typer.Option(help="Which matches to render as Rerun recordings."),
    ] = "first",
    out: OutOption = None,
    fresh: FreshOption = False,
    db: Annotated[Path, typer.Option(help="The leaderboard's database.")] = Path("out/wildscav.db"),
    sandbox: InSandbox = None,
    executor: ExecutorOption = "local",
    address: AddressOption = None,
    sign: SignOption = None,
    log_format: LogOption = None,
    metrics_port: MetricsOption = None,
    as_json: AsJson = False,
) -> None:
    """Let submissions play each other, and rate them by their places.

    Everyone plays equally often, and each map is played again with the seats exchanged. The same command
    continues a tournament that was interrupted; the order of the entrants does not matter.
    """
    from wildscav_evaluator.cli.options.selection import check_suite_has, check_track, suite_seed
    from wildscav_evaluator.cli.options.tournament import (
        chosen_settings,
        load_entrants,
        most_entries,
    )
    from wildscav_evaluator.cli.sessions.tournament import run_tournament
    from wildscav_evaluator.monitoring.monitor import MonitorOptions
    from wildscav_evaluator.output.numbered_folders import TOURNAMENTS
    from wildscav_evaluator.plans.tournament import TournamentPlan
    from wildscav_evaluator.suites.suite_file import find_suite

    chosen = find_suite(suite)
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
    first = suite_seed(seed, secret)
    key = signing_key(sign, out or TOURNAMENTS, loaded)
    with executor_of(executor, address, jobs) as machines:
        runs_in, loaded = chosen_sandbox(sandbox, loaded, machines)
        if key is not None:
            warn_of_open_key(runs_in)
        plan = TournamentPlan(
            submissions=loaded,
            robots=playing_robots,
            track=track,
            settings=settings,
            suite=chosen,
            seed=first,
            rounds=rounds,
            replays=replays,
            jobs=machines.at_once,
            out=out or TOURNAMENTS,
            fresh=fresh,
            sandbox=runs_in,
            key=key,
        )
        options = MonitorOptions(log_format, metrics_port)
        run_tournament(plan if out else plan.in_own_folder(), db, options, machines, as_json=as_json)
