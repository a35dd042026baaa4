"""``wildscav human``: a person plays a match in the browser."""

import asyncio
import contextlib
import re
import webbrowser
from collections.abc import Callable
from contextlib import AbstractContextManager
from dataclasses import dataclass, replace
from importlib.metadata import entry_points
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from wildscav.cli.shared_options import RulesOption, takes
from wildscav.errors import UserError
from wildscav.system.output_folders import check_folder
from wildscav.system.ports import check_port

if TYPE_CHECKING:
    from wildscav_stage.playing.plan import Plan

SUITES = "wildscav.people_suites"  # entry points: functions that let a person play the matches of a suite
RECORDS = Path("out/human")
NAME = r"[a-z0-9][a-z0-9-]{1,39}"


@dataclass(frozen=True)
class Serving:
    """How the page is served."""

    host: Annotated[str, typer.Option(help="Address that the page is served on.")] = "127.0.0.1"
    port: Annotated[int, typer.Option(help="Its port; 0 for any free one.", min=0, max=65535)] = 0
    public_url: Annotated[
        str | None,
        typer.Option(
            help="Where others reach the page, behind a proxy: https://play.example.org.", metavar="URL"
        ),
    ] = None
    spectator_delay: Annotated[
        float | None,
        typer.Option(
            help="Seconds after which spectators see a match. Default: 3 where several people play, else 0.",
            min=0,
            max=60,
            show_default=False,
        ),
    ] = None
    browser: Annotated[bool, typer.Option(help="Open the page in a browser.")] = True

    def checked(self) -> "Serving":
        """Return this with the proxy's address as links have it; UserError if it or the port is wrong."""
        from wildscav_stage.playing.links import checked_public_url

        check_port(self.host, self.port)  # before anything is compiled
        url = self.public_url
        return self if url is None else replace(self, public_url=checked_public_url(url))


@takes(Serving)
def human(
    serving: Serving,
    track: Annotated[
        str | None,
        typer.Option(help="Track to play. Default: battle, or all of --suite.", show_default=False),
    ] = None,
    suite: Annotated[
        str | None,
        typer.Option(
            help="Play the matches of this suite, such as reading, one after another and each once; the "
            "results stand on the board beside those of agents.",
            show_default=False,
        ),
    ] = None,
    name: Annotated[
        str | None,
        typer.Option(help="With --suite: your name on the board. Default: person.", show_default=False),
    ] = None,
    fresh: Annotated[bool, typer.Option("--fresh", help="With --suite: play all matches again.")] = False,
    at_range: Annotated[
        bool,
        typer.Option("--range", help="Practise shooting, at targets that stand, walk and strafe."),
    ] = False,
    map_id: Annotated[
        int | None,
        typer.Option(
            "--map", help="Number of a map, 1 to 999. Default: a small map made from --seed.", metavar="ID"
        ),
    ] = None,
    opponents: Annotated[
        str | None,
        typer.Option(
            help="Who else plays: robots and folders of submissions, separated by commas; '' for nobody. "
            "Default: in battle and royale, some robots.",
            metavar="NAME|DIR,…",
            show_default=False,
        ),
    ] = None,
    people: Annotated[
        int,
        typer.Option(
            help="How many people can play: you, and others by links that are printed.", min=1, max=8
        ),
    ] = 1,
    seed: Annotated[
        int, typer.Option(help="Seed of the first match; the next has the next.", min=0, max=2**63)
    ] = 0,
    time_limit: Annotated[
        float | None,
        typer.Option(help="Seconds of game time. Default: the track's.", min=1, max=3600, show_default=False),
    ] = None,
    rules: RulesOption = "original",
    records: Annotated[
        Path | None,
        typer.Option(
            help="Folder for the records of the matches. Default: out/human, or with --suite a new one in "
            "out/evaluations.",
            show_default=False,
        ),
    ] = None,
) -> None:
    """Play yourself, in the browser, against other people, robots and submissions; Ctrl-C ends it.

    Submissions run without a sandbox, so name only those whose code you trust.
    """
    from wildscav_stage.playing.plan import PERSON, make_plan, make_range
    from wildscav_stage.viewer_files import viewer_file

    viewer_file("play.js")
    check_folder("--records", records or RECORDS)
    serving = serving.checked()
    names = None if opponents is None else [name.strip() for name in opponents.split(",") if name.strip()]
    is_usual = map_id is None and names is None and people == 1
    if suite is not None:
        if at_range or not is_usual or time_limit is not None or rules != "original":
            raise UserError("--suite says what is played, by one person against its robots", exit_code=2)
        with _suites()(_checked_name(name or PERSON), suite, seed, track, records, fresh=fresh) as first:
            if first is not None and first.given is not None:
                _play(first, first.given.record.parent, serving)
        return
    if name is not None or fresh:
        raise UserError("--name and --fresh are for the matches of a --suite", exit_code=2)
    if at_range:
        if track not in (None, "battle") or not is_usual:
            raise UserError("--range has a map and targets of its own, for one person", exit_code=2)
        plan = make_range(seed, time_limit, rules)
    else:
        plan = make_plan(track or "battle", map_id, seed, names, time_limit, people, rules)
    _play(plan, records or RECORDS, serving)


def _suites() -> "Callable[..., AbstractContextManager[Plan | None]]":
    """Return what lets a person play the matches of a suite.

    Raises:
        UserError: The package that does is not installed.
    """
    for point in entry_points(group=SUITES):
        found: Callable[..., AbstractContextManager[Plan | None]] = point.load()
        return found
    raise UserError("--suite needs the evaluator: pip install 'wildscav[evaluator]'", exit_code=2)


def _checked_name(name: str) -> str:
    if not re.fullmatch(NAME, name):
        raise UserError(
            f"--name is {name!r}, must be 2 to 40 of a-z, 0-9 and -, a letter or digit first", exit_code=2
        )
    return name


def _play(plan: "Plan", records: Path, serving: Serving) -> None:
    """Serve a table until Ctrl-C."""
    from wildscav.terminal.console import console
    from wildscav_engine.compilation.engine_progress import preparing
    from wildscav_stage.playing.site.serve import prepare

    with preparing(console):
        prepare(plan)
    with contextlib.suppress(KeyboardInterrupt):
        asyncio.run(_serve(plan, records, serving))


async def _serve(plan: "Plan", records: Path, serving: Serving) -> None:
    from wildscav.terminal.console import console
    from wildscav_stage.playing.site.serve import served

    def say(line: str) -> None:
        console.print(line)

    public_url, delay = serving.public_url, serving.spectator_delay
    at = serving.host, serving.port
    async with served(plan, records, *at, say, public_url=public_url, delay=delay) as (links, web):
        say(f"play at {links.host}")
        for number, link in enumerate(links.guests, start=2):
            say(f"person {number} plays at {link}")
        if links.entrance:
            say(f"or others join at {links.entrance}")
        say(f"spectators watch at {links.watch}")
        if serving.browser:
            await asyncio.to_thread(webbrowser.open, links.host)
        await web
