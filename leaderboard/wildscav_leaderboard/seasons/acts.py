"""An act is one function, of which its route, form, command and line in the audit log are made.

The function's signature says what the act takes; keyword-only arguments are options of the command. Each
argument's type has its meaning and its limits, which are checked alike wherever it comes from.
"""

import inspect
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass
from datetime import datetime
from functools import cached_property
from string import Formatter
from types import NoneType
from typing import Any, Literal, NamedTuple, get_args, get_origin

from annotated_types import MaxLen
from pydantic import BaseModel, ValidationError, create_model
from pydantic.fields import FieldInfo
from sqlalchemy.orm import Session

from wildscav_leaderboard.seasons.folder import Season
from wildscav_leaderboard.seasons.refusals import InvalidError
from wildscav_leaderboard.seasons.state import log_act

EMPTY = ("", 0, None)  # how forms and commands leave out what is optional


class Doing(NamedTuple):
    """Who does an act, and where and when."""

    session: Session  # that writes
    season: Season
    actor: str  # the name of an account, or "command line (USER)"
    now: datetime


@dataclass(frozen=True)
class Act:
    """An act."""

    effect: Callable[..., Any]
    title: str  # on buttons
    # What it is done to, for the audit log of privileged acts. All texts name arguments in braces.
    subject: str = ""
    detail: str = ""
    path: str = ""  # of its route
    command: str = ""  # of organizers; if acts share one, the first argument chooses
    says: str = ""  # what the command prints afterwards

    @property
    def name(self) -> str:
        """What forms call it."""
        return self.effect.__name__.replace("_", "-")

    @property
    def help(self) -> str:
        """What it does."""
        return " ".join((self.effect.__doc__ or "").partition("\n\n")[0].split())

    @property
    def parameters(self) -> dict[str, inspect.Parameter]:
        """What it takes."""
        found = inspect.signature(self.effect).parameters
        return {name: one for name, one in found.items() if name != "doing"}

    def choices(self, name: str) -> tuple[str, ...]:
        """Return what an argument may be; nothing if it is not one of a few words."""
        found = self.fields[name].annotation
        return get_args(found) if get_origin(found) is Literal else ()

    def longest(self, name: str) -> int:
        """Return how many characters an argument may have; 0 if it is not a text."""
        return next((one.max_length for one in self.fields[name].metadata if isinstance(one, MaxLen)), 0)

    @cached_property
    def _model(self) -> type[BaseModel]:
        return self.model(self.parameters)

    @property
    def fields(self) -> dict[str, FieldInfo]:
        """What is known of its arguments."""
        return self._model.model_fields

    @property
    def in_path(self) -> list[str]:
        """The arguments that are part of its route's path."""
        return [name for _, name, _, _ in Formatter().parse(self.path) if name]

    @property
    def on_forms(self) -> list[str]:
        """The arguments that forms and the API take; commands take all."""
        return [name for name, field in self.fields.items() if not field.exclude]

    @property
    def returns(self) -> Any:
        """The type of what it returns."""
        return inspect.signature(self.effect).return_annotation

    def model(self, names: Collection[str]) -> type[BaseModel]:
        """Return a model that checks some of its arguments."""
        taken = [one for name, one in self.parameters.items() if name in names]
        fields = {
            one.name: (one.annotation, ... if one.default is one.empty else one.default) for one in taken
        }
        name = self.effect.__name__.title().replace("_", "")
        return create_model(name, __doc__=self.help, **fields)  # type: ignore[call-overload,no-any-return]

    def read(self, given: Mapping[str, Any]) -> dict[str, Any]:
        """Return all arguments, checked. This may take a while, so it comes before the transaction.

        Raises:
            InvalidError: One is missing or not allowed.
        """
        taken = dict(given)
        for name in given:
            field = self.fields[name]
            if given[name] in EMPTY and not field.is_required():
                del taken[name]
                if NoneType in get_args(field.annotation):
                    taken[name] = None
        try:
            read = self._model.model_validate(taken)
        except ValidationError as error:
            first = error.errors()[0]
            raise InvalidError(f"{first['loc'][0]}: {first['msg']}") from None
        return {name: getattr(read, name) for name in self.fields}

    def do(self, doing: Doing, arguments: Mapping[str, Any]) -> Any:
        """Do it, and enter it in the audit log if it is privileged.

        Args:
            doing: Who does it, and where and when.

        Returns:
            What its function returns.
        """
        result = self.effect(doing, **arguments)
        verb, subject, detail = self.effect.__name__.replace("_", " "), self.subject, self.detail
        shown = {name: "any number of" if one is None else one for name, one in arguments.items()}
        if subject:
            log_act(
                doing.session, doing.actor, verb, subject.format(**shown), doing.now, detail.format(**shown)
            )
        return result

    def __call__(self, doing: Doing, *values: Any, **named: Any) -> Any:
        """Do it with arguments that are not checked yet."""
        given = inspect.signature(self.effect).bind(doing, *values, **named).arguments
        return self.do(
            doing, self.read({name: one for name, one in given.items() if name in self.parameters})
        )
