"""``wildscav dataset``: episodes of records, or of an agent, as a data set of Minari."""

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from wildscav.cli.shared_options import AsJson
from wildscav.errors import UserError
from wildscav_training.cli.track_and_level import known_track

if TYPE_CHECKING:
    from wildscav_training.datasets.episodes import Episode
    from wildscav_training.datasets.from_agent import PlayedEpisodes
    from wildscav_training.datasets.from_records import RecordedEpisodes
    from wildscav_training.datasets.minari_files import Written

MATCHES, MAX_MATCHES = 100, 1_000_000  # to play: unless said otherwise, and at most

Records = Annotated[
    list[Path] | None, typer.Argument(help="Record files.", metavar="[RECORD]…", show_default=False)
]
Identity = Annotated[
    str, typer.Option("--id", help="Name and version, such as navigation/mapper-v0.", show_default=False)
]
Seats = Annotated[
    list[int] | None,
    typer.Option("--seat", help="Seat of the records; repeatable. Default: all submissions.", min=0),
]
Names = Annotated[
    list[str] | None, typer.Option("--name", help="Agent of the records by its name; repeatable.")
]
Agent = Annotated[
    str | None,
    typer.Option(
        help="Instead of records: a submission's folder, a baseline or oracle. Its code is trusted."
    ),
]
Track = Annotated[str | None, typer.Option(help="With --agent: the track. Default: navigation.")]
Matches = Annotated[
    int | None, typer.Option(help="With --agent: matches to play. Default: 100.", min=1, max=MAX_MATCHES)
]
Seed = Annotated[int | None, typer.Option(help="With --agent: seed of the first match. Default: 0.", min=0)]
Options = Annotated[
    list[str] | None,
    typer.Option(
        "--option", metavar="NAME=VALUE", help="An option of the environment, its value as JSON; repeatable."
    ),
]
Together = Annotated[
    bool, typer.Option("--together", help="One episode for all seats of a match: several learners.")
]


def dataset(
    name: Identity,
    records: Records = None,
    seat: Seats = None,
    agent_name: Names = None,
    agent: Agent = None,
    track: Track = None,
    matches: Matches = None,
    seed: Seed = None,
    option: Options = None,
    together: Together = False,
    as_json: AsJson = False,
) -> None:
    """Make a data set for offline learning, which minari.load_dataset reads.

    Its episodes are those of records, played again exactly, or those that an agent plays now. Observations
    and actions are those of the environments, of version 1 unless an option says otherwise.

    With --json: `id`, `folder`, `episodes`, `steps` and `mean_return`.
    """
    from wildscav.terminal.console import console, print_json
    from wildscav_training.cli.from_policy import read_option

    of_agent = {"--track": track, "--matches": matches, "--seed": seed}
    of_records = {"--seat": seat, "--name": agent_name}
    _check_choice(records, agent, {**of_agent} if agent is None else of_records)
    from wildscav_training.datasets.from_agent import PlayedEpisodes
    from wildscav_training.datasets.from_records import RecordedEpisodes

    options = dict(map(read_option, option or []))
    source: PlayedEpisodes | RecordedEpisodes
    if agent is None:
        seats, names = seat or (), agent_name or ()
        source = RecordedEpisodes(records or [], options, seats=seats, names=names, together=together)
        what = f"{source.count} records"
    else:
        track, count = known_track(track or "navigation"), matches or MATCHES
        source = PlayedEpisodes(agent, track, options, matches=count, seed=seed or 0, together=together)
        what = f"{source.count} matches of {agent}"
    written = _write(name, source, options, what)
    console.print(
        f"{written.id}: {written.episodes:,} episodes, {written.steps:,} steps, mean return "
        f"{written.mean_return:.3f}, in {written.folder}",
    )
    console.print(f'Next, in Python: minari.load_dataset("{written.id}")')
    if as_json:
        print_json({**written._asdict(), "folder": str(written.folder)})


def _check_choice(records: list[Path] | None, agent: str | None, unused: dict[str, Any]) -> None:
    """Check that there are records or an agent, and no options of the other."""
    if bool(records) == (agent is not None):
        both = "records and --agent are both given" if records else "there are no episodes"
        raise UserError(f"{both}: name record files, or an agent that plays with --agent", exit_code=2)
    for option, value in unused.items():
        if value is not None and value != []:
            other = "--agent" if agent is None else "records"
            raise UserError(f"{option} goes only with {other}", exit_code=2)


def _write(
    name: str, source: "PlayedEpisodes | RecordedEpisodes", options: dict[str, Any], what: str
) -> "Written":
    """Write the episodes of a source, and show the progress."""
    from wildscav.terminal.console import error_console, progress_bar
    from wildscav_engine.compilation.engine_progress import preparing
    from wildscav_training.datasets.minari_files import check_id, env_spec, write

    check_id(name)
    config = source.config
    shape = {name: getattr(config, name) for name in ("version", "frames_per_action", "time_limit")}
    spec = env_spec(config.track, {**shape, **options}, source.spaces)

    def episodes(advance: Any) -> "Iterator[Episode]":
        for match in source:
            yield from match
            advance()

    with preparing(error_console), progress_bar() as progress:
        task = progress.add_task("matches", total=source.count)
        found = episodes(lambda: progress.advance(task))
        return write(name, found, source.spaces, spec, f"Wildscav, {config.track}: {what}")
