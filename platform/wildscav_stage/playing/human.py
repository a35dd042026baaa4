"""``wildscav human``: a person plays a match in the browser."""

import asyncio
import contextlib
import webbrowser
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from wildscav.cli.shared_options import RulesOption
from wildscav.errors import UserError
from wildscav.system.output_folders import check_folder

if TYPE_CHECKING:
    from wildscav_stage.playing.plan import Plan


def human(
    track: Annotated[str, typer.Option(help="Track to play.")] = "battle",
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
    host: Annotated[str, typer.Option(help="Address that the page is served on.")] = "127.0.0.1",
    port: Annotated[int, typer.Option(help="Its port; 0 for any free one.", min=0, max=65535)] = 0,
    public_url: Annotated[
        str | None,
        typer.Option(
            help="Where others reach the page, behind a proxy: https://play.example.org.", metavar="URL"
        ),
    ] = None,
    spectator_delay: Annotated[
        float | None,
        typer.Option(
            help="Seconds after which spectators see a match. Default: 3 where several people play, else 0.",
            min=0,
            max=60,
            show_default=False,
        ),
    ] = None,
    browser: Annotated[bool, typer.Option(help="Open the page in a browser.")] = True,
    records: Annotated[Path, typer.Option(help="Folder for the records of the matches.")] = Path("out/human"),
) -> None:
    """Play yourself, in the browser, against other people, robots and submissions; Ctrl-C ends it.

    Submissions run without a sandbox, so name only those whose code you trust.
    """
    from wildscav.terminal.console import console
    from wildscav_engine.compilation.engine_progress import preparing
    from wildscav_stage.playing.links import checked_public_url
    from wildscav_stage.playing.plan import make_plan, make_range
    from wildscav_stage.playing.site.serve import prepare
    from wildscav_stage.viewer_files import viewer_file

    viewer_file("play.js")
    check_folder("--records", records)
    public = None if public_url is None else checked_public_url(public_url)
    names = None if opponents is None else [name.strip() for name in opponents.split(",") if name.strip()]
    if at_range:
        if track != "battle" or map_id is not None or names is not None or people > 1:
            raise UserError("--range has a map and targets of its own, for one person", exit_code=2)
        plan = make_range(seed, time_limit, rules)
    else:
        plan = make_plan(track, map_id, seed, names, time_limit, people, rules)
    with preparing(console):
        prepare(plan)
    with contextlib.suppress(KeyboardInterrupt):
        asyncio.run(_serve(plan, records, host, port, public, spectator_delay, browser=browser))


async def _serve(
    plan: "Plan",
    records: Path,
    host: str,
    port: int,
    public_url: str | None,
    delay: float | None,
    *,
    browser: bool,
) -> None:
    from wildscav.terminal.console import console
    from wildscav_stage.playing.site.serve import served

    def say(line: str) -> None:
        console.print(line)

    async with served(plan, records, host, port, say, public_url=public_url, delay=delay) as (links, serving):
        say(f"play at {links.host}")
        for number, link in enumerate(links.guests, start=2):
            say(f"person {number} plays at {link}")
        if links.entrance:
            say(f"or others join at {links.entrance}")
        say(f"spectators watch at {links.watch}")
        if browser:
            await asyncio.to_thread(webbrowser.open, links.host)
        await serving
