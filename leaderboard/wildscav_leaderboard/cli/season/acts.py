"""The commands of `wildscav season` that change something: each is entered in the audit log."""

from collections.abc import Iterator
from contextlib import contextmanager
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from wildscav.terminal.console import console
from wildscav_leaderboard.cli.season.folder_argument import SeasonFolder

if TYPE_CHECKING:
    from sqlalchemy.orm import Session

Why = Annotated[str, typer.Option("--reason", "-r", help="Why; everyone sees it.", show_default=False)]

AccountName = Annotated[str, typer.Argument(help="The name of the account.", show_default=False)]
Password = Annotated[
    str | None,
    typer.Option(help="Its password; a new one is made if it is not given.", envvar="WILDSCAV_PASSWORD"),
]


@contextmanager
def writing(folder: Path) -> "Iterator[Session]":
    """Open a season's database to write."""
    from wildscav_leaderboard.seasons.folder import Season

    database = Season.open(folder).database()
    try:
        database.upgrade()
        with database.writing() as session:
            yield session
    finally:
        database.close()


def _now() -> datetime:
    return datetime.now(UTC)


def _say(text: str) -> None:
    console.print(text, soft_wrap=True, highlight=False, markup=False)


def invite(
    folder: SeasonFolder,
    label: Annotated[str, typer.Option(help="For whom it is.")] = "",
    uses: Annotated[
        int, typer.Option(help="How many people may register with it; 0 for any number.", min=0)
    ] = 1,
    organizer: Annotated[bool, typer.Option("--organizer", help="For organizers.")] = False,
) -> None:
    """Print the key of a new invitation, with which people register. It is shown this once."""
    from wildscav_leaderboard.accounts.models import COMPETITOR, ORGANIZER
    from wildscav_leaderboard.organizing import service

    role = ORGANIZER if organizer else COMPETITOR
    with writing(folder) as session:
        key = service.invite(session, service.COMMAND_LINE, label, _now(), role=role, uses=uses or None)
    _say(key)


def organizer(
    folder: SeasonFolder,
    name: AccountName,
    password: Password = None,
) -> None:
    """Make an account of an organizer, who sees the organizer's pages."""
    from wildscav_leaderboard.accounts.passwords import hashed, new_password
    from wildscav_leaderboard.organizing import service

    chosen = new_password() if password is None else password
    secret = hashed(chosen)
    with writing(folder) as session:
        service.add_organizer(session, service.COMMAND_LINE, name, secret, _now())
    _say_password(name, chosen, is_new=password is None)


def password(folder: SeasonFolder, name: AccountName, password: Password = None) -> None:
    """Give an account another password; it is logged out everywhere, and its tokens are revoked."""
    from wildscav_leaderboard.accounts.passwords import hashed, new_password
    from wildscav_leaderboard.organizing import service

    chosen = new_password() if password is None else password
    secret = hashed(chosen)
    with writing(folder) as session:
        service.reset_password(session, service.COMMAND_LINE, name, secret, _now())
    _say_password(name, chosen, is_new=password is None)


def _say_password(name: str, password: str, *, is_new: bool) -> None:
    _say(f"account  {name}")
    if is_new:
        _say(f"password {password}   (shown this once)")


def disable(
    folder: SeasonFolder,
    name: AccountName,
    reason: Annotated[
        str, typer.Option("--reason", "-r", help="Why; its owner is told.", show_default=False)
    ],
) -> None:
    """Let an account no longer be used. What its team handed in goes on."""
    from wildscav_leaderboard.organizing import service

    with writing(folder) as session:
        service.disable_account(session, service.COMMAND_LINE, name, reason, _now())
    _say(f"the account {name} is disabled")


def enable(folder: SeasonFolder, name: AccountName) -> None:
    """Let a disabled account be used again."""
    from wildscav_leaderboard.organizing import service

    with writing(folder) as session:
        service.enable_account(session, service.COMMAND_LINE, name, _now())
    _say(f"the account {name} may be used again")


def pause(folder: SeasonFolder, reason: Why = "maintenance") -> None:
    """Let nothing new be begun; what is being played is finished."""
    from wildscav_leaderboard.organizing import service

    with writing(folder) as session:
        service.pause(session, service.COMMAND_LINE, reason, _now())
    _say("paused")


def resume(folder: SeasonFolder) -> None:
    """Let a paused season go on."""
    from wildscav_leaderboard.organizing import service

    with writing(folder) as session:
        service.resume(session, service.COMMAND_LINE, _now())
    _say("the season goes on")


def announce(
    folder: SeasonFolder,
    title: Annotated[str, typer.Argument(help="The title.", show_default=False)],
    text: Annotated[str, typer.Argument(help="The text.")] = "",
) -> None:
    """Show an announcement on the season's page."""
    from wildscav_leaderboard.organizing import service

    with writing(folder) as session:
        service.announce(session, "the organizers", title, text, _now())
    _say("announced")


def disqualify(
    folder: SeasonFolder,
    what: Annotated[str, typer.Argument(help="A team's name, or a submission's number.", show_default=False)],
    reason: Why,
) -> None:
    """Take a team or a submission off all boards."""
    from wildscav_leaderboard.organizing import service

    with writing(folder) as session:
        if what.isascii() and what.isdigit():
            service.disqualify_submission(session, service.COMMAND_LINE, int(what), reason, _now())
        else:
            service.disqualify_team(session, service.COMMAND_LINE, what, reason, _now())
    _say(f"{what} is disqualified")


def rerun(
    folder: SeasonFolder,
    submission: Annotated[int, typer.Argument(help="The number of a submission.", show_default=False)],
) -> None:
    """Try a failed submission again, or play the matches again that were given up."""
    from wildscav_leaderboard.organizing import service

    with writing(folder) as session:
        service.rerun(session, service.COMMAND_LINE, submission, _now())
    _say(f"submission {submission} is tried again")


def freeze(folder: SeasonFolder) -> None:
    """Keep the public boards as they are; organizers still see the hidden ones."""
    from wildscav_leaderboard.organizing import service

    with writing(folder) as session:
        service.freeze(session, service.COMMAND_LINE, _now())
    _say("the public boards are frozen")
