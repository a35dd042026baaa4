"""The command ``wildscav login``."""

import os
import socket
import sys
from typing import TYPE_CHECKING, Annotated

import typer

from wildscav.cli.shared_options import AsJson
from wildscav.errors import UserError
from wildscav.terminal.console import console, error_console, print_json, printable
from wildscav_leaderboard.competing import texts
from wildscav_leaderboard.competing.connected import TOKEN_VARIABLE

if TYPE_CHECKING:
    from wildscav_leaderboard.api.documents import AccountView, SeasonView
    from wildscav_leaderboard.competing.logins import Logins
    from wildscav_leaderboard.competing.season_client import SeasonClient

SHORTEST = 10  # characters of a password; not imported, because what hashes them takes long to load
LONGEST_LABEL = 60  # characters
Url = Annotated[
    str | None,
    typer.Argument(
        help="Address of the season. Default: the one that you logged in to last.",
        metavar="URL",
        show_default=False,
    ),
]


def login(
    url: Url = None,
    name: Annotated[
        str | None, typer.Option(help="Name of your account. Asked for if it is not given.")
    ] = None,
    password: Annotated[
        str | None,
        typer.Option(
            help="Its password. Better asked for, or read from standard input.", envvar="WILDSCAV_PASSWORD"
        ),
    ] = None,
    token: Annotated[
        str | None,
        typer.Option(
            help="A token of your account, in place of its name and password.", envvar=TOKEN_VARIABLE
        ),
    ] = None,
    register: Annotated[bool, typer.Option("--register", help="Make a new account.")] = False,
    invitation: Annotated[
        str | None, typer.Option(help="Key of an invitation, for --register.", show_default=False)
    ] = None,
    log_out: Annotated[
        bool, typer.Option("--logout", help="Log out instead: the token is revoked and forgotten.")
    ] = False,
    as_json: AsJson = False,
) -> None:
    """Log in to a season, or out of it; the commands that follow are about this one.

    The token that the season gives is kept in a file that only you can read.

    With --json: `url`, `season`, `title`, and `account`: `name`, `role`, `team`, `quota`.

    With --json, with --logout: `url`, and whether the token was `revoked`.
    """
    from wildscav_leaderboard.competing.connection import Connection, is_open_to_others
    from wildscav_leaderboard.competing.logins import Login, Logins
    from wildscav_leaderboard.competing.season_client import SeasonClient

    _check_options(token, invitation, register=register)
    if log_out:
        return _log_out(url, as_json=as_json)
    logins = Logins.read()
    address = _address(url, logins)
    if is_open_to_others(address):
        _warn(f"{address} is not encrypted: others on the way can read your password and your token")
    with Connection(address) as connection:
        visitor = SeasonClient(connection)
        season = visitor.season()
        if register:
            token = _registered(visitor, season, name, password, invitation)
        elif token is None and name is None and password is None and _is_valid(logins, address):
            token = logins.seasons[address].token
        elif token is None:
            token = visitor.new_token(name or _asked("Name"), password or _secret("Password"), _label())
    with Connection(address, token) as connection:
        account = SeasonClient(connection).me()
    kept = Login(name=account.name, title=season.title, token=token.strip())
    logins.with_login(address, kept).save()
    return _show(address, season, account, as_json=as_json)


def _log_out(url: str | None, *, as_json: bool) -> None:
    """Revoke the token of a season and forget it."""
    from wildscav_leaderboard.competing.connection import Connection
    from wildscav_leaderboard.competing.logins import Logins
    from wildscav_leaderboard.competing.season_client import SeasonClient

    logins = Logins.read()
    address = _address(url, logins)
    if address not in logins.seasons:
        raise UserError(f"you are not logged in to {address}")
    revoked = True
    try:
        with Connection(address, logins.seasons[address].token) as connection:
            SeasonClient(connection).revoke_own_token()
    except UserError as error:
        revoked = False
        _warn(f"the token was forgotten here, but not revoked there: {error}")
    logins.without(address).save()
    if as_json:
        print_json({"url": address, "revoked": revoked})
    texts.say(f"logged out of {address}")


def _check_options(token: str | None, invitation: str | None, *, register: bool) -> None:
    """Refuse options that do not go together."""
    if invitation is not None and not register:
        raise UserError("--invitation is for a new account: add --register", exit_code=2)
    if register and token is not None and TOKEN_VARIABLE not in os.environ:
        raise UserError("--token is for an account that there is, --register for a new one", exit_code=2)


def _address(url: str | None, logins: "Logins") -> str:
    """Return the address of the season that is meant."""
    from wildscav_leaderboard.competing.connection import season_url

    if url is not None:
        return season_url(url)
    if logins.current is None:
        raise UserError("you are logged in to no season: name one, as in `wildscav login URL`", exit_code=2)
    return logins.current


def _is_valid(logins: "Logins", address: str) -> bool:
    """Return whether the token of an earlier login can still be used."""
    from wildscav_leaderboard.competing.connection import AnswerError, Connection
    from wildscav_leaderboard.competing.season_client import SeasonClient

    if address not in logins.seasons:
        return False
    try:
        with Connection(address, logins.seasons[address].token) as connection:
            SeasonClient(connection).me()
    except AnswerError:
        return False
    return True


def _registered(
    visitor: "SeasonClient",
    season: "SeasonView",
    name: str | None,
    password: str | None,
    invitation: str | None,
) -> str:
    """Make a new account, and return its token."""
    if invitation is None and season.registration != "open":
        invitation = _asked("Key of your invitation", "--invitation")
    name = name or _asked("Name (a-z, 0-9 and -)")
    password = password or _secret("Password", twice=True)
    return visitor.register(name, password, invitation).token


def _asked(what: str, option: str = "--name") -> str:
    """Ask for one line at a terminal; standard input that is none has the password alone."""
    if not sys.stdin.isatty():
        raise UserError(f"{option} is missing: standard input is read for the password alone", exit_code=2)
    answer: str = typer.prompt(what, err=True)
    return answer.strip()


def _secret(what: str, *, twice: bool = False) -> str:
    """Ask for a secret, which is not shown; or read it from standard input, if that is no terminal."""
    if sys.stdin.isatty():
        asked = f"{what} ({SHORTEST} or more characters)" if twice else what
        answer: str = typer.prompt(asked, hide_input=True, confirmation_prompt=twice, err=True)
        return answer
    given = sys.stdin.readline().rstrip("\n")
    if not given:
        raise UserError(
            f"there is no {what.lower()}: type it at a terminal, write it to standard input, or set "
            "WILDSCAV_PASSWORD",
            exit_code=2,
        )
    return given


def _label() -> str:
    """Return how the account's page names the token of this machine."""
    return printable(f"wildscav login on {socket.gethostname()}")[:LONGEST_LABEL].strip()


def _show(address: str, season: "SeasonView", account: "AccountView", *, as_json: bool) -> None:
    if as_json:
        print_json({"url": address, "season": season.name, "title": season.title, "account": account})
    texts.say(f"logged in to {season.title}, {address}")
    team = account.team.name if account.team is not None else ""
    none_yet = "none yet: `wildscav team create NAME`, or `wildscav team join KEY`"
    rows = {
        "account": account.name + ("" if account.role == "competitor" else f" ({account.role})"),
        "team": team or none_yet,
        "quota": "" if account.quota is None else texts.quota(account.quota),
        "closes": f"{season.closes:%Y-%m-%d %H:%M} UTC",
        "paused": season.paused or "",
    }
    console.print(texts.facts(rows))


def _warn(text: str) -> None:
    error_console.print(f"warning: {printable(text)}", style="yellow")
