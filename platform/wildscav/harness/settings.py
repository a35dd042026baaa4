"""How a model is asked, and what it may spend: from a TOML file, and from the environment."""

import os
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, field, fields, replace
from pathlib import Path
from typing import Any, Self

from wildscav.errors import UserError, describe
from wildscav.harness.connection import SOCKET

ADDRESS_VARIABLES = ("WILDSCAV_MODEL", "OPENAI_BASE_URL")  # the gateway's of a sandbox comes first
KEY_VARIABLE = "OPENAI_API_KEY"
OWN_FIELDS = frozenset(("model", "messages", "tools", "stream"))  # of requests; answers come in one piece
TEXTS, FLAGS = ("url", "name", "key", "instructions"), ("pictures", "marks")
BOUNDS = {  # what each number may be
    "window": (1, 1_000),
    "lines": (0, 1_000),
    "notes": (0, 20_000),
    "timeout": (0.01, 86_400.0),
    "retries": (0, 100),
    "pause": (0.0, 60.0),
    "tokens": (1, 10**12),
    "seconds": (0.01, 10**9),
    "money": (0.0, 10**9),
    "prompt_price": (0.0, 10**9),
    "answer_price": (0.0, 10**9),
}


@dataclass(frozen=True, slots=True)
class ModelSettings:
    """Which model plays, what it is shown, and what it may spend in a match.

    Raises:
        UserError: A value is not allowed.
    """

    url: str = "https://api.openai.com/v1"  # of the server, up to the version; or unix:/path of a gateway
    name: str = ""  # of the model there; none: the first that the server lists
    key: str = field(default="", repr=False)  # of the server, if it wants one
    request: Mapping[str, Any] = field(default_factory=lambda: {"max_tokens": 1024})  # further fields
    instructions: str = ""  # added to what the model is told of its task
    pictures: bool = False  # whether it sees what the seat's camera shows
    marks: bool = True  # whether boxes and agents have their numbers in pictures
    window: int = 8  # past answers that it sees as they were; of those before, a line each
    lines: int = 40  # such lines
    notes: int = 2_000  # characters that it may keep for itself
    timeout: float = 120.0  # s for an answer; a gateway has its own
    retries: int = 4  # of a request that failed, likewise
    pause: float = 0.5  # s before the first of them; each next one waits twice as long
    # What it may spend in a match; None: any amount.
    tokens: int | None = None  # of prompts and answers
    seconds: float | None = None  # s in which it is waited for
    money: float | None = None  # in the currency of the prices
    prompt_price: float = 0.0  # of a million tokens of prompts
    answer_price: float = 0.0  # of a million tokens of answers
    log: Path | None = None  # the file for requests and answers (JSON lines); None: no file

    def __post_init__(self) -> None:
        for name, (least, most) in BOUNDS.items():
            value = getattr(self, name)
            kind = int if type(least) is int else int | float
            if value is None and name in ("tokens", "seconds", "money"):
                continue
            if type(value) is bool or not isinstance(value, kind) or not least <= value <= most:
                raise UserError(f"the model's {name} is {value!r}, must be {least:,} to {most:,}", 2)
        for names, one_kind, said in ((TEXTS, str, "a text"), (FLAGS, bool, "true or false")):
            for name in names:
                if not isinstance(getattr(self, name), one_kind):
                    raise UserError(f"the model's {name} must be {said}", 2)
        if not self.url.startswith(("http://", "https://", SOCKET)):
            raise UserError(f"the model's url is {self.url!r}, must begin with http://, https:// or unix:", 2)
        if not (self.key.isascii() and self.key.isprintable()):
            raise UserError("the model's key has characters that no header may have", 2)
        if not isinstance(self.request, Mapping):
            raise UserError("the model's request must be a table of further fields of requests", 2)
        if self.log is not None and not isinstance(self.log, Path):
            raise UserError(f"the model's log is {self.log!r}, must be the name of a file", 2)
        if own := sorted(OWN_FIELDS & self.request.keys()):
            raise UserError(f"the model's request has {', '.join(own)}, which every request has already", 2)

    @classmethod
    def of(cls, table: Mapping[str, Any]) -> Self:
        """Return the settings in a table.

        Raises:
            UserError: A name is unknown, or a value is not allowed.
        """
        known = [one.name for one in fields(cls)]
        for name in table:
            if name not in known:
                raise UserError(f"the model's settings have no {name!r}; they have {', '.join(known)}", 2)
        log = {"log": Path(table["log"])} if isinstance(table.get("log"), str) else {}
        return cls(**(dict(table) | log))

    def in_environment(self, environment: Mapping[str, str] | None = None) -> Self:
        """Return these settings with the address and the key in an environment, by default the process's."""
        environment = os.environ if environment is None else environment
        found: dict[str, Any] = {}
        for variable in reversed(ADDRESS_VARIABLES):
            if environment.get(variable):
                found["url"] = environment[variable]
        if environment.get(KEY_VARIABLE):
            found["key"] = environment[KEY_VARIABLE]
        return replace(self, **found)


def read_settings(path: Path) -> ModelSettings:
    """Return the settings in a TOML file, with the address and the key of the environment.

    Raises:
        UserError: The file cannot be read, or is not valid.
    """
    try:
        return ModelSettings.of(tomllib.loads(path.read_text("utf-8"))).in_environment()
    except OSError as error:
        raise UserError(f"cannot read the model's settings: {describe(error)}", 2) from None
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise UserError(f"{path} is not valid TOML: {error}", 2) from None
