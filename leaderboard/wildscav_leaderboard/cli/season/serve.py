"""The command ``wildscav season serve``."""

from typing import Annotated

import typer

from wildscav_leaderboard.cli.season.opening import SeasonFolder


def serve(
    folder: SeasonFolder,
    web: Annotated[bool, typer.Option("--web", help="Only the web site and the API.")] = False,
    conductor: Annotated[
        bool, typer.Option("--conductor", help="Only the conductor, which plays the matches.")
    ] = False,
    host: Annotated[str | None, typer.Option(help="Address to listen on.")] = None,
    port: Annotated[int | None, typer.Option(help="Port to listen on.", min=0, max=65_535)] = None,
    metrics_port: Annotated[
        int | None, typer.Option(help="Serve Prometheus metrics to this machine.", min=0, max=65_535)
    ] = None,
    log_format: Annotated[str, typer.Option(help="text or json.")] = "text",
) -> None:
    """Run a season: the web site with its API, and the conductor that has matches played."""
    from wildscav.errors import UserError
    from wildscav.terminal.console import console
    from wildscav_leaderboard.hosting.ports import check_certificate, check_port
    from wildscav_leaderboard.hosting.serve import CONDUCTOR, WEB
    from wildscav_leaderboard.hosting.serve import serve as run
    from wildscav_leaderboard.organizing.checking import check_rules
    from wildscav_leaderboard.seasons.folder import Season

    if log_format not in ("text", "json"):
        raise UserError(f"--log-format is {log_format!r}, must be text or json", exit_code=2)
    season = Season.open(folder)
    chosen = {"host": host, "port": port, "metrics_port": metrics_port}
    changed = season.settings.web.model_copy(
        update={name: value for name, value in chosen.items() if value is not None}
    )
    parts = tuple(name for name, wanted in ((WEB, web), (CONDUCTOR, conductor)) if wanted)
    parts = parts or (WEB, CONDUCTOR)
    if WEB not in parts and any(value is not None for value in chosen.values()):
        raise UserError(
            "--host, --port and --metrics-port belong to the web site, not --conductor", exit_code=2
        )
    if WEB in parts:
        check_certificate(season)
        changed = changed.model_copy(update={"port": check_port(changed.host, changed.port)})
    season = Season(season.folder, season.settings.model_copy(update={"web": changed}))
    for line in check_rules(season):
        console.print(line, soft_wrap=True)
    if WEB in parts:
        console.print(f"{season.settings.title}: {changed.address} (Ctrl-C ends it)", soft_wrap=True)
    run(season, parts, "json" if log_format == "json" else "text")
