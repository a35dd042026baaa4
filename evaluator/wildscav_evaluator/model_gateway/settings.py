"""The settings of a model that seats may ask: a TOML file, or the part ``[model]`` of a season's settings."""

import os
import tomllib
from pathlib import Path
from typing import Annotated, Literal
from urllib.parse import urlsplit

from pydantic import BaseModel, ConfigDict, Field, JsonValue, ValidationError, model_validator

from wildscav.errors import UserError, describe
from wildscav_engine.specs.validation import one_line
from wildscav_engine.storage.files import read_limited

LARGEST = 4 << 10  # bytes of the file
LONGEST_KEY = 8 << 10  # bytes
GATEWAYS_OWN = frozenset(("model", "messages", "tools", "stream", "n", "max_tokens", "max_completion_tokens"))

Count = Annotated[int, Field(ge=1, le=10**12)]
Amount = Annotated[float, Field(ge=0.0, le=1e9, allow_inf_nan=False)]
Seconds = Annotated[float, Field(gt=0.0, le=604_800.0)]


class ModelSettings(BaseModel):
    """The organizer's model: where it is, how it is asked, and how much a seat may ask of it in a match."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    url: Annotated[str, Field(pattern=r"^https?://[^\s?#@]+$")]  # up to the version: "http://host:8000/v1"
    name: Annotated[str, Field(min_length=1, max_length=200)]  # of the model, as its server knows it
    key_env: str | None = None  # the environment variable that holds the server's key
    key_file: Path | None = None  # or the file that does
    max_tokens: Annotated[int, Field(ge=1, le=1_000_000)] = 1024  # of an answer
    max_tokens_field: Literal["max_tokens", "max_completion_tokens"] = "max_tokens"  # as the server calls it
    extra: dict[str, JsonValue] = {}  # more fields of every request, such as cache_prompt = false
    cache_salt: bool = False  # whether each seat gets its own cache of prompts; vLLM knows this field
    timeout: Seconds = 120.0  # s for an answer
    retries: Annotated[int, Field(ge=0, le=10)] = 2  # of a request that the server failed
    # The budget of a seat in a match:
    requests: Count = 2_000  # that it may send
    tokens: Count = 1_000_000  # of prompts and answers
    seconds: Seconds = 7_200.0  # s in which the model's server worked on its requests
    money: Amount | None = None  # in the currency of the prices
    prompt_price: Amount = 0.0  # of a million tokens of prompts
    answer_price: Amount = 0.0  # of a million tokens of answers

    @model_validator(mode="after")
    def _consistent(self) -> "ModelSettings":
        self._check_url()
        if self.key_env is not None and self.key_file is not None:
            raise ValueError("key_env and key_file are given: the key is in one of them")
        if own := sorted(GATEWAYS_OWN & self.extra.keys()):
            raise ValueError(f"extra has {', '.join(own)}: the gateway sets that itself")
        if self.money is not None and not self.prompt_price + self.answer_price:
            raise ValueError("money is a budget, but prompt_price and answer_price are 0")
        return self

    def _check_url(self) -> None:
        try:
            is_whole = urlsplit(self.url).hostname and urlsplit(self.url).port != 0
        except ValueError:  # of a port
            is_whole = False
        if not is_whole:
            raise ValueError(f"url {self.url} has no host, or a port that cannot be")

    @property
    def host(self) -> str:
        """The host of its server, with the port if the URL has one."""
        return urlsplit(self.url).netloc

    def key(self) -> str:
        """Return the server's key; an empty text if it needs none.

        Raises:
            UserError: There is no such variable or file.
        """
        if self.key_env is not None and not os.environ.get(self.key_env):
            raise UserError(
                f"the variable {self.key_env}, which the model's settings name for the key, is not set", 2
            )
        try:
            in_file = read_limited(self.key_file, LONGEST_KEY).decode() if self.key_file else ""
        except (OSError, UnicodeDecodeError) as error:
            reason = describe(error) if isinstance(error, OSError) else "it is not text"
            raise UserError(f"the model's key cannot be read from {self.key_file}: {reason}", 2) from error
        key = (os.environ[self.key_env] if self.key_env else in_file).strip()
        if not (key.isascii() and (not key or key.isprintable())):
            raise UserError("the model's key has characters that no header may have", 2)
        return key


def read_model(path: Path) -> ModelSettings:
    """Read the settings of a model, and check that its key is there.

    Raises:
        UserError: They are missing or not valid, or the key is missing.
    """
    try:
        settings = ModelSettings.model_validate(tomllib.loads(read_limited(path, LARGEST).decode("utf-8")))
    except OSError as error:
        raise UserError(f"the model's settings {path} cannot be read: {describe(error)}", 2) from error
    except ValidationError as error:
        raise UserError(f"the model's settings {path}: {one_line(error)}", 2) from None
    except (ValueError, RecursionError) as error:
        raise UserError(f"the model's settings {path} are not TOML: {error}", 2) from None
    if settings.key_file is not None:  # relative to the file
        settings = settings.model_copy(update={"key_file": path.absolute().parent / settings.key_file})
    settings.key()
    return settings
