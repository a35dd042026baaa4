"""Conductors on one season that may die at any statement: what a stormy season is made of."""

import shutil
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from datetime import datetime, timedelta
from pathlib import Path
from typing import Any

from hypothesis.stateful import RuleBasedStateMachine
from sqlalchemy import event
from sqlalchemy.orm import Session
from tests.leaderboard.seasons_made import NOON, make_season, team_with_member

from wildscav_leaderboard.conductor.lease import Holding, LeaseLostError
from wildscav_leaderboard.database.connection import Database
from wildscav_leaderboard.seasons.folder import Season

MORE = """
matches = 4
waiting = 2

[deadlines]
building = 100
validating = 100
attempts = 2
"""
TEAMS = ("foxes", "owls")
CONDUCTORS = ("first", "second")
NOBODY = Holding("nobody", 0)
NEVER = 10_000  # statements; no transaction has so many


class CutOffError(Exception):
    """The process ended in the middle of a transaction."""


@dataclass
class Process:
    """A conductor's process: its clock, its lease, and the work that it has under way."""

    ahead: timedelta = timedelta()  # its clock, of the right time
    holding: Holding = NOBODY
    work: list[int] = field(default_factory=list)  # attempts
    past: list[int] = field(default_factory=list)  # attempts whose news it brought


class Template:
    """A season with two teams, made once and copied for each example."""

    def __init__(self) -> None:
        self._folder = tempfile.TemporaryDirectory(prefix="storm-")
        self.path = Path(self._folder.name) / "season"
        season = make_season(self.path, MORE)
        database = season.database()
        database.upgrade()
        with database.writing() as session:
            for name in TEAMS:
                team_with_member(session, name)
        database.close()


class Storm(RuleBasedStateMachine):
    """A copy of a season, and conductors whose transactions may be cut off."""

    template: Template | None = None

    def __init__(self) -> None:
        super().__init__()
        kind = type(self)
        kind.template = kind.template or Template()
        self._folder = tempfile.TemporaryDirectory(prefix="storm-")
        folder = Path(self._folder.name) / "season"
        shutil.copytree(kind.template.path, folder)
        self.season = Season.open(folder)
        self.database: Database = self.season.database()
        self.processes = {name: Process() for name in CONDUCTORS}
        self.time, self.number, self.started = NOON, 0, 0
        self.epoch = 0
        self.results: dict[int, str] = {}  # digests of the records of the results that were stored
        self.ladder: list[tuple[int, str, float]] = []
        self.forgiven: dict[int, int] = {}
        self._left: list[int] = [NEVER]
        event.listen(self.database._writers, "before_cursor_execute", self._count)

    def _count(self, *_: Any) -> None:
        self._left[0] -= 1
        if self._left[0] < 0:
            raise CutOffError

    @contextmanager
    def transaction(self, fate: int = NEVER) -> Iterator[Session]:
        """Yield a session that writes, and that is cut off after so many statements."""
        try:
            with self.database.writing() as session:
                self._left[0] = fate
                yield session
        finally:
            self._left[0] = NEVER

    def step(self, process: Process, fate: int, act: Callable[[Session, datetime], Any]) -> Any:
        """Let a conductor do something in a transaction. It dies if that is cut off, or its lease is lost."""
        current = process.holding.epoch == self.epoch
        try:
            with self.transaction(fate) as session:
                value = act(session, self.time + process.ahead)
        except CutOffError:
            self.die(process)
            return None
        except LeaseLostError:
            assert not current, "a conductor with the current epoch holds the lease"
            self.die(process)
            return None
        assert current, "a conductor with an old epoch wrote something"
        return value

    def process(self, name: str | None) -> Process:
        """Return a process: of that name, or else the one that holds the lease, if it is alive."""
        if name is not None:
            return self.processes[name]
        alive = (one for one in self.processes.values() if one.holding.epoch == self.epoch)
        return next(alive, self.processes[CONDUCTORS[0]])

    @staticmethod
    def die(process: Process) -> None:
        """End a process; what it had under way may still send news."""
        process.past += process.work
        process.work, process.holding = [], NOBODY
