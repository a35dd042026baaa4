"""The command ``wildscav tournament``."""

from pathlib import Path

from wildscav.cli.json_option import AsJson
from wildscav_evaluator.cli.options.evaluation import (
    DatabaseOption,
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
from wildscav_evaluator.cli.options.tournament_arguments import (
    Entrants,
    MeetOwnOption,
    MixedOption,
    RepeatsOption,
    ReplaysOption,
    RobotsOption,
    RoundsOption,
    SeatsOption,
    TeamSizeOption,
    TrackOption,
)


def tournament(
    entrants: Entrants,
    track: TrackOption,
    suite: SuiteOption = "quick",
    rounds: RoundsOption = 6,
    seats: SeatsOption = None,
    team_size: TeamSizeOption = None,
    mixed: MixedOption = False,
    repeats: RepeatsOption = None,
    robots: RobotsOption = None,
    meet_own: MeetOwnOption = False,
    seed: SeedOption = None,
    secret: SecretOption = None,
    jobs: JobsOption = None,
    replays: ReplaysOption = "first",
    out: OutOption = None,
    fresh: FreshOption = False,
    db: DatabaseOption = Path("out/wildscav.db"),
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
