"""The arguments and options that several of ``evaluate``, ``compare``, ``tournament`` and ``play`` have.

The command line imports this module to show its help, so it imports nothing heavy.
"""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal, TypeVar

import typer

from wildscav.cli.shared_options import AsJson
from wildscav_evaluator.bounds import MAX_ROUNDS
from wildscav_evaluator.cli.options.running import (
    AddressOption,
    ExecutorOption,
    InSandbox,
    ModelOption,
    chosen_model,
    chosen_sandbox,
    executor_of,
)
from wildscav_evaluator.cli.options.signing import SignOption, check_hidden, signing_key, warn_of_open_key

if TYPE_CHECKING:
    from wildscav_evaluator.executors import Executor
    from wildscav_evaluator.monitoring.monitor import MonitorOptions
    from wildscav_evaluator.plans.plan import Plan
    from wildscav_evaluator.submissions.submission import Submission
    from wildscav_evaluator.suites.suite import Suite

AnyPlan = TypeVar("AnyPlan", bound="Plan")

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
        "at a rich hot spot (20 of gathering, battle and royale). fair: the same meetings as eyes see them, "
        "with bodies that turn and aim as a person can. reading: 6 short ones per track with few decisions, "
        "rated across all tracks. Or the file of your own suite (.toml)."
    ),
]
ClockOption = Annotated[
    str | None,
    typer.Option(
        "--clock",
        metavar="CLOCK[,NAME=NUMBER]",
        help="What agents' time is, instead of the suite's clock. bank: a budget for each step, and a bank. "
        "paused (or paused,budget=600): the match waits for all answers. running,pace=2: it goes on, 2 s of "
        "game time a second. tokens,token_time=0.02,processor_time=1: a thought costs game time, by its "
        "tokens and by its seconds of a processor.",
        show_default=False,
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
        help="File with a hidden seed (`wildscav season secret new`), instead of --seed.", show_default=False
    ),
]

RoundsOption = Annotated[
    int,
    typer.Option(help="How often to play the suite, each time with the next seed.", min=1, max=MAX_ROUNDS),
]


def _say_no_database(path: Path | None) -> None:
    if path is not None:
        from wildscav.terminal.console import error_console

        error_console.print(
            "--db has no effect, and the next release removes it: `wildscav leaderboard` reads the results "
            "in output folders, by default those in out"
        )


NoDatabase = Annotated[
    Path | None, typer.Option("--db", hidden=True, callback=_say_no_database, show_default=False)
]


@dataclass(frozen=True)
class PlayOptions:
    """The options of every command that plays the matches of a suite into an output folder."""

    suite: SuiteOption = "quick"
    clock: ClockOption = None
    seed: SeedOption = None
    secret: SecretOption = None
    workers: Annotated[
        int | None,
        typer.Option(help="Matches at once. Default: one per processor core.", min=1, show_default=False),
    ] = None
    out: Annotated[
        Path | None,
        typer.Option(
            "--out",
            "-o",
            help="Output folder. Default: a new folder with the next number, or the one in which the same "
            "command was interrupted.",
            show_default=False,
        ),
    ] = None
    fresh: Annotated[
        bool,
        typer.Option(
            "--fresh",
            help="Play everything again: into a new folder or, with --out, replacing what that folder holds.",
            show_default=False,
        ),
    ] = False
    sandbox: InSandbox = None
    interface: Annotated[
        Literal["numbers", "words", "keys"] | None,
        typer.Option(
            help="Take only submissions that play by this interface. Default: any; results say by which.",
            show_default=False,
        ),
    ] = None
    executor: ExecutorOption = "local"
    address: AddressOption = None
    sign: SignOption = None
    log_format: Annotated[
        Literal["json", "text"] | None,
        typer.Option(
            help="Write log lines in this format to stderr instead of showing a dashboard.",
            show_default=False,
        ),
    ] = None
    model: ModelOption = None
    metrics_port: Annotated[
        int | None,
        typer.Option(
            help="Serve Prometheus metrics on this port of this machine; 0 takes a free one.",
            min=0,
            max=65_535,
            show_default=False,
        ),
    ] = None
    as_json: AsJson = False

    @property
    def monitor(self) -> "MonitorOptions":
        """How to show the progress."""
        from wildscav_evaluator.monitoring.monitor import MonitorOptions

        return MonitorOptions(self.log_format, self.metrics_port)

    def find_suite(self) -> "Suite":
        """Return the suite to play, with the clock that replaces its own."""
        from wildscav_evaluator.cli.options.selection import clock_choice
        from wildscav_evaluator.suites.suite_file import find_suite

        suite = find_suite(self.suite)
        return suite if self.clock is None else replace(suite, clock=clock_choice(self.clock))

    @contextmanager
    def planned(
        self, make: "Callable[..., AnyPlan]", submissions: "tuple[Submission, ...]", parent: Path, **more: Any
    ) -> "Iterator[tuple[AnyPlan, Executor]]":
        """Yield a plan with these options, and the executor that is to play it.

        ``parent`` has the numbered output folders, for when none is named; ``more`` are the plan's other
        fields.
        """
        from wildscav_evaluator.cli.options.selection import check_interface, suite_seed

        check_interface(submissions, self.interface)
        if self.secret is not None:
            own = () if self.out is None else (self.out,)  # which --fresh empties, besides
            check_hidden("--secret", self.secret, (*own, *(one.folder for one in submissions)))
        seed, out = suite_seed(self.seed, self.secret), self.out or parent
        key, model = signing_key(self.sign, out, submissions), chosen_model(self.model, submissions)
        with executor_of(self.executor, self.address, self.workers) as machines:
            sandbox, submissions = chosen_sandbox(self.sandbox, submissions, machines)
            if key is not None:
                warn_of_open_key(sandbox)
            plan = make(
                submissions=submissions,
                seed=seed,
                jobs=machines.at_once,
                out=out,
                fresh=self.fresh,
                sandbox=sandbox,
                key=key,
                model=model,
                **more,
            )
            yield plan if self.out else plan.in_own_folder(), machines


@dataclass(frozen=True)
class TournamentOptions(PlayOptions):
    """The options of a tournament: what is played, and who sits where."""

    rounds: Annotated[
        int,
        typer.Option(
            help="How many rounds to play. After each, every entrant has played equally often. In fewer "
            "than 6 games, no two entrants can be told apart.",
            min=1,
            max=MAX_ROUNDS,
        ),
    ] = 6
    seats: Annotated[
        int | None,
        typer.Option(
            help="Seats of entrants in a match. Default: as many as the suite's matches have, or fewer if "
            "there are fewer entrants.",
            min=2,
            max=1000,
            show_default=False,
        ),
    ] = None
    team_size: Annotated[
        int | None,
        typer.Option(
            help="Seats of a team, all filled by one entrant. Default: 2 on capture, otherwise 1.",
            min=1,
            max=500,
            show_default=False,
        ),
    ] = None
    mixed: Annotated[
        bool, typer.Option("--mixed", help="Fill the seats of a team with different entrants.")
    ] = False
    repeats: Annotated[
        int | None,
        typer.Option(
            help="How often each map and match seed is played, each time in other seats. Default: 2.",
            min=1,
            max=1000,
            show_default=False,
        ),
    ] = None
    robots: Annotated[
        str | None,
        typer.Option(
            help="Robots in further seats, which are not rated: how many, or which, such as "
            "fighter,gatherer-hard. Default: none.",
            show_default=False,
        ),
    ] = None
    meet_own: Annotated[
        bool, typer.Option("--meet-own", help="Let several entries of one submission meet.")
    ] = False
