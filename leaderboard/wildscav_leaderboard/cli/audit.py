"""The command ``wildscav audit``."""

from typing import Annotated

import typer

from wildscav.cli.shared_options import AsJson


def _count(text: str) -> str:
    """Check a number of records."""
    if text not in ("all", "none") and not (text.isascii() and text.isdigit()):
        raise typer.BadParameter(f"{text!r} is no number, nor all or none")
    return text


def audit(
    place: Annotated[
        str,
        typer.Argument(
            help="The address of a season's web site, or a folder that `wildscav season export` wrote.",
            metavar="URL|DIR",
            show_default=False,
        ),
    ],
    track: Annotated[str | None, typer.Option(help="Only this track.", show_default=False)] = None,
    records: Annotated[
        str,
        typer.Option(
            help="How many records of each track to download: all, none, or a number, chosen at random.",
            metavar="N|all|none",
            callback=_count,
        ),
    ] = "all",
    replay: Annotated[
        str,
        typer.Option(
            help="How many of these to play again, which takes time: all, none, or a number.",
            metavar="N|all|none",
            callback=_count,
        ),
    ] = "all",
    commitment: Annotated[
        str | None,
        typer.Option(help="The commitment that you noted when the season began.", show_default=False),
    ] = None,
    jobs: Annotated[
        int | None, typer.Option(help="Records to play at once. Default: one per processor core.", min=1)
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Recompute a season's boards from what is published of it. Exit code 0 only if every digit is right.

    Records are played again, and every score, interval, band and rating is computed from them. Once the
    season's secret is opened, it must be the one of the commitment, and give exactly the matches that were
    played. Before, what is published so far is checked, and the rest is listed.
    """
    from wildscav_evaluator.cli.options.running import executor_of
    from wildscav_leaderboard.auditing.record_checks import Wanted
    from wildscav_leaderboard.cli.audit_session import run_audit

    numbers = {"all": None, "none": 0}
    wanted = Wanted(
        track=track,
        records=numbers[records] if records in numbers else int(records),
        replay=numbers[replay] if replay in numbers else int(replay),
        commitment=None if commitment is None else commitment.strip().lower(),
    )
    with executor_of("local", None, jobs) as executor:
        run_audit(place, wanted, executor, as_json=as_json)
