"""The command ``wildscav verify``: records, evaluations and seasons, played again and compared."""

import re
from importlib.metadata import entry_points
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from wildscav.cli.shared_options import AsJson
from wildscav.errors import UserError
from wildscav.system.output_folders import check_folder
from wildscav_evaluator.cli.options.running import (
    AddressOption,
    ExecutorOption,
    InSandbox,
    chosen_sandbox,
    executor_of,
)
from wildscav_evaluator.cli.options.signing import KeyOption
from wildscav_evaluator.output.layout import SEASON_FILE
from wildscav_inspect.records import PAGE, SeasonOption, resolve_record

if TYPE_CHECKING:
    from wildscav_evaluator.executors import Executor

COUNTS = {"all": None, "none": 0}  # of records, besides numbers
# The options that each kind of thing takes, besides --json.
OPTIONS = {
    "records": {"--key", "--season"},
    "a record with --agent": {"--agent", "--seat", "--logs", "--sandbox", "--season"},
    "an evaluation": {"--key", "--commitment", "--workers", "--executor", "--address"},
    "a season": {"--commitment", "--track", "--download", "--resimulate", "--workers"},
}
DEFAULTS = {"--download": "all", "--resimulate": "all", "--executor": "local"}


def _count(text: str) -> str:
    """Check a number of records."""
    if text not in COUNTS and not (text.isascii() and text.isdigit()):
        raise typer.BadParameter(f"{text!r} is no number, nor all or none")
    return text


Places = Annotated[
    list[str],
    typer.Argument(
        help="Records (files, or numbers of a season's matches); or the folder of one evaluation; or one "
        "season: its address, or a folder that `wildscav season export` wrote.",
        metavar="RECORD…|FOLDER|URL",
        show_default=False,
    ),
]
Commitment = Annotated[
    str | None,
    typer.Option(
        help="Of an evaluation or a season: the commitment of its secret, as you noted it beforehand.",
        show_default=False,
    ),
]
Track = Annotated[str | None, typer.Option(help="Of a season: only this track.", show_default=False)]
Download = Annotated[
    str,
    typer.Option(
        help="Of a season: how many records of each track to download, chosen at random.",
        metavar="N|all|none",
        callback=_count,
    ),
]
Resimulate = Annotated[
    str,
    typer.Option(
        help="Of a season: how many of these to play again, which takes time.",
        metavar="N|all|none",
        callback=_count,
    ),
]
Agent = Annotated[
    str | None,
    typer.Option(
        help="Run this submission again in the record's match, and compare its actions with the record: "
        "a folder with a submission.toml, an archive of one, or image:NAME.",
        metavar="SUBMISSION",
        show_default=False,
    ),
]
Seat = Annotated[
    list[int] | None,
    typer.Option(
        help="With --agent: compare this seat; may be repeated. Default: the submission's own seats.",
        min=0,
    ),
]
Logs = Annotated[Path | None, typer.Option(help="With --agent: folder for its output. Default: out/verify.")]
Workers = Annotated[
    int | None, typer.Option(help="Records to play at once. Default: one per processor core.", min=1)
]


def verify(
    context: typer.Context,
    places: Places,
    key: KeyOption = None,
    commitment: Commitment = None,
    track: Track = None,
    download: Download = "all",
    resimulate: Resimulate = "all",
    agent: Agent = None,
    seat: Seat = None,
    logs: Logs = None,
    sandbox: InSandbox = None,
    workers: Workers = None,
    executor: ExecutorOption = "local",
    address: AddressOption = None,
    season: SeasonOption = None,
    as_json: AsJson = False,
) -> None:
    """Play what was recorded again, and compare every step and every number. Exit code 0 only if all holds.

    A record that holds is a true account of its match: the actions of every seat, and their result. Of an
    evaluation or a season, every table is computed again as well, and every entrant must have exactly the
    matches of the suite. Only a ledger that the organizer signed (--key) proves which submission played, in
    which sandbox, and whose fault it was when an agent ended early.

    With --agent, all seats play the recorded actions, so the agent sees exactly what it saw then. An agent
    that reads a clock, or uses threads or its own random numbers, may differ although its code is the same.

    With --json, of records: `records`: `path`, `holds`, `message` of each.

    With --json, of a record with --agent: `record`, and `seats`: `seat`, `name`, `status` and `late_steps` of
    this replay, `steps`, `differing` (how many), `first` (the first that differs), `difference` of each.

    With --json, of a folder: `folder`, `results` as the records give them, `disagreements`, and `unchecked`
    (what cannot be proven yet), a line each.

    With --json, of a season: `season`, `address`, `commitments`, `holds`; `checks`: `track`, `what`,
    `checked` (how many) of each, and `unchecked`: `count` and `why`; `findings`: `problem`, `track`, `team`,
    `submission`, `match`, `field`, `published`, `expected` of each.
    """
    kind = _kind_of(places, agent)
    given = {
        "--key": key,
        "--commitment": commitment,
        "--track": track,
        "--download": download,
        "--resimulate": resimulate,
        "--agent": agent,
        "--seat": seat,
        "--logs": logs,
        "--season": season,
        # Not the environment's, which is for every command that runs agents.
        "--sandbox": sandbox if _is_written(context, "sandbox") else None,
        "--workers": workers,
        "--executor": executor,
        "--address": address,
    }
    _check_options(given, kind, places[0])
    if kind == "a season":
        with executor_of("local", None, workers) as machines:
            _audit(
                places[0],
                machines,
                track,
                commitment,
                _number(download),
                _number(resimulate),
                as_json=as_json,
            )
    elif kind == "an evaluation":
        _rescore(Path(places[0]), key, commitment, executor_of(executor, address, workers), as_json=as_json)
    elif agent is not None:
        record = resolve_record(Path(places[0]), season)
        _run_again(record, agent, seat or [], logs, sandbox, as_json=as_json)
    else:
        from wildscav_evaluator.cli.sessions.verify_records import verify_records

        verify_records([resolve_record(Path(place), season) for place in places], key, as_json=as_json)


def _is_written(context: typer.Context, parameter: str) -> bool:
    """Return whether a parameter is in the command itself, and not in the environment alone."""
    source = context.get_parameter_source(parameter)
    return source is not None and source.name == "COMMANDLINE"


def _check_options(given: dict[str, Any], kind: str, place: str) -> None:
    """Refuse options that are for other kinds of things."""
    for option, value in given.items():
        if option not in OPTIONS[kind] and value is not None and value != DEFAULTS.get(option):
            others = " or ".join(kind for kind, options in OPTIONS.items() if option in options)
            raise UserError(f"{option} is for {others}; {place} is {kind}", exit_code=2)


def _kind_of(places: list[str], agent: str | None) -> str:
    """Return what the places are, as OPTIONS names it.

    UserError if they are several things that need a command each.
    """
    kinds = {_kind_of_one(place) for place in places}
    if len(places) == 1 or kinds == {"records"}:
        kind = kinds.pop()
    else:
        raise UserError("verify takes records, or one evaluation, or one season", exit_code=2)
    if agent is None:
        return kind
    if kind != "records" or len(places) > 1:
        raise UserError("--agent is for one record", exit_code=2)
    return "a record with --agent"


def _kind_of_one(place: str) -> str:
    if PAGE.fullmatch(place):
        return "records"
    if "://" in place or (Path(place) / SEASON_FILE).is_file():
        return "a season"
    return "an evaluation" if Path(place).is_dir() else "records"


def _number(text: str) -> int | None:
    """Return a number of records; None for all."""
    return COUNTS[text] if text in COUNTS else int(text)


def _audit(*arguments: Any, as_json: bool) -> None:
    """Audit a season by what another package registers for it; UserError if none does, or it has faults."""
    from wildscav_evaluator.cli.sessions.verify_records import AUDITS

    for point in entry_points(group=AUDITS):
        point.load()(*arguments, as_json=as_json)
        return
    raise UserError("a season needs the leaderboard: pip install 'wildscav[leaderboard]'", exit_code=2)


def _rescore(
    out: Path, key: str | None, commitment: str | None, executor: "Executor", *, as_json: bool
) -> None:
    """Verify an evaluation, and that its secret is the one that was committed to."""
    from wildscav_evaluator.cli.sessions.rescore import run_rescore, show_commitment
    from wildscav_evaluator.ledger.keys import read_public

    commitment = None if commitment is None else commitment.strip().lower()
    if commitment is not None and not re.fullmatch("[0-9a-f]{64}", commitment):
        raise UserError(f"--commitment is {commitment!r}, must be 64 hexadecimal digits", exit_code=2)
    public = None if key is None else read_public(key)
    if commitment is not None:
        show_commitment(out, commitment)
    with executor as machines:
        run_rescore(out, machines, public, as_json=as_json)


def _run_again(
    record: Path, agent: str, seats: list[int], logs: Path | None, sandbox: str | None, *, as_json: bool
) -> None:
    """Run a submission again in a recorded match."""
    from wildscav_evaluator.cli.options.selection import load_submissions
    from wildscav_evaluator.cli.sessions.run_again import run_again

    check_folder("--logs", logs or Path("out/verify"), is_default=logs is None)
    logs = logs or Path("out/verify")
    loaded = load_submissions([Path(agent)])
    if loaded[0].manifest.model:
        raise UserError(
            f"submission {loaded[0].name!r} asks a language model, and verify offers none", exit_code=2
        )
    runs_in, (submission,) = chosen_sandbox(sandbox, loaded)
    run_again(record, submission, seats=seats, logs=logs, sandbox=runs_in, as_json=as_json)
