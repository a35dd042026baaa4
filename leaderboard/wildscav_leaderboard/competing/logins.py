"""The seasons that the user is logged in to, in a file that only they can read.

The tokens in it are as good as passwords, so the file's mode is 0600 from its first byte.
"""

import os
from dataclasses import dataclass, replace
from pathlib import Path

import typer
from pydantic import BaseModel, ConfigDict, ValidationError

from wildscav.errors import UserError, describe

FILE = "seasons.json"
FOLDER_VARIABLE = "WILDSCAV_CONFIG_DIR"
OWNER_ONLY = 0o600


class Login(BaseModel):
    """A season, and the token of the user's account there."""

    model_config = ConfigDict(frozen=True)

    name: str  # of the account
    title: str  # of the season
    token: str


class _Content(BaseModel):
    current: str | None = None
    seasons: dict[str, Login] = {}


@dataclass(frozen=True)
class Logins:
    """All logins of the user, by address; the current one is used where none is named."""

    path: Path
    seasons: dict[str, Login]
    current: str | None

    @classmethod
    def read(cls) -> "Logins":
        """Read the user's file; there may be none. It is in the folder where the system keeps settings.

        Raises:
            UserError: It cannot be read, or was damaged.
        """
        path = Path(os.environ.get(FOLDER_VARIABLE) or typer.get_app_dir("wildscav")) / FILE
        try:
            content = _Content.model_validate_json(path.read_bytes())
        except FileNotFoundError:
            content = _Content()
        except OSError as error:
            raise UserError(describe(error)) from None
        except ValidationError:
            raise UserError(f"{path} is damaged: remove it, and log in again") from None
        return cls(path, content.seasons, content.current if content.current in content.seasons else None)

    def with_login(self, url: str, login: Login) -> "Logins":
        """Return these logins with another one, which is the current one from now on."""
        return replace(self, seasons={**self.seasons, url: login}, current=url)

    def without(self, url: str) -> "Logins":
        """Return these logins without one; the latest of the others becomes the current one."""
        others = {other: login for other, login in self.seasons.items() if other != url}
        current = self.current if self.current in others else next(reversed(others), None)
        return replace(self, seasons=others, current=current)

    def save(self) -> None:
        """Write the file, whole or not at all.

        Raises:
            UserError: It cannot be written.
        """
        content = _Content(current=self.current, seasons=self.seasons).model_dump_json(indent=2)
        fresh = self.path.with_name(f".{FILE}.{os.getpid()}")
        try:
            self.path.parent.mkdir(parents=True, exist_ok=True, mode=0o700)
            fresh.unlink(missing_ok=True)
            with open(os.open(fresh, os.O_WRONLY | os.O_CREAT | os.O_EXCL, OWNER_ONLY), "w") as file:  # noqa: PTH123
                file.write(content)
            fresh.replace(self.path)
        except OSError as error:
            raise UserError(f"the login cannot be stored: {describe(error)}") from None
