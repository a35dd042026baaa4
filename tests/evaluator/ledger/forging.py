"""What somebody who can write to an evaluation's folder may do to it."""

import json
import shutil
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from wildscav_engine.record import read_record, write_record
from wildscav_engine.simulation.match import Match
from wildscav_evaluator.ledger.entries import Closed, Entry, Fact, MatchEnded, Opened, digest_of_line
from wildscav_evaluator.ledger.keys import SigningKey
from wildscav_evaluator.ledger.ledger import sha256_of
from wildscav_evaluator.output.identity import Identity, read_identity, write_identity
from wildscav_evaluator.output.layout import LEDGER_FILE, stem_of
from wildscav_evaluator.output.results import (
    Evaluation,
    MatchRow,
    Results,
    SeatRow,
    read_results,
    write_results,
)
from wildscav_evaluator.scores.score import summary

Change = Callable[[MatchRow], MatchRow | None]  # none takes the match out
Rescored = Callable[..., str]  # rescores a folder that must be refused, and returns the lines that say why


@dataclass
class Forgery:
    """A copy of an evaluation's folder that is changed step by step."""

    out: Path

    @property
    def results(self) -> Results:
        return read_results(self.out / "results.json")

    @property
    def identity(self) -> Identity:
        found = read_identity(self.out)
        assert found is not None
        return found

    def evaluation(self, name: str) -> Evaluation:
        return next(one for one in self.results.evaluations if one.submission == name)

    def tell(self, **fields: object) -> None:
        """Write something else into the results."""
        write_results(self.results.model_copy(update=fields), self.out)

    def tell_of(self, name: str, **fields: object) -> None:
        """Write something else of a submission into the results."""
        self.tell(
            evaluations=tuple(
                one.model_copy(update=fields if one.submission == name else {})
                for one in self.results.evaluations
            )
        )

    def change_matches(self, name: str, change: Change) -> None:
        """Change a submission's matches in the results, and all that is computed from them."""
        before = self.evaluation(name)
        rows = tuple(row for one in before.matches if (row := change(one)) is not None)
        self.tell_of(name, matches=rows, summary=summary(before.metrics, rows))

    def record(self, name: str, index: int) -> Path:
        """The file of a match's record."""
        return self.out / "records" / f"navigation-{index:03d}-{name}.wsr"

    def remove_match(self, name: str, index: int) -> None:
        """Take away a match's record."""
        self.record(name, index).unlink()

    def play_otherwise(self, name: str, index: int) -> dict[str, float]:
        """Put in a well-formed record of the same match with other actions, and return its metrics."""
        path = self.record(name, index)
        record = read_record(path)
        match, target = Match(record.spec), record.spec
        match.seeds = dict(enumerate(record.seeds))
        start = match.start_info(0)
        assert start.target is not None
        assert target.seats == ("submission",)
        east, north = start.target[0] - start.position[0], start.target[2] - start.position[2]
        actions = np.zeros((1, 8), np.float32)
        actions[0, :2] = np.degrees(np.arctan2(east, north)), 10.0
        while not match.over:
            match.step(actions)
        write_record(path, match, record.names)
        return dict(match.result().seats[0].metrics)

    def identify(self, **fields: object) -> None:
        """Write something else into evaluation.json."""
        write_identity(self.identity.model_copy(update=fields), self.out)

    def rows(self) -> dict[str, MatchRow]:
        """Return how every match went, by its stem; in a tournament, the seats of all entrants together."""
        found: dict[str, MatchRow] = {}
        for one in self.results.evaluations:
            for row in one.matches:
                stem = stem_of(one.track, row.index, one.submission if self.alone else None)
                seats = (*found[stem].seats, *row.seats) if stem in found else row.seats
                together = tuple(sorted(seats, key=lambda seat: seat.seat))
                found[stem] = MatchRow.of(row.index, together, row.record) if together else row
        return found

    @property
    def alone(self) -> bool:
        """Whether each submission was evaluated alone."""
        return self.results.tournament is None

    def facts(self) -> list[Fact]:
        lines = (self.out / LEDGER_FILE).read_bytes().splitlines()
        return [Entry.model_validate_json(line).fact for line in lines]

    def rewrite_ledger(self, key: SigningKey | None = None) -> None:
        """Have the ledger say what all else says, every digest right, signed with a key or not at all."""
        rows = self.rows()
        public = None if key is None else key.public
        self.identify(key=public)
        self.tell(key=public)
        told = [self._retold(fact, rows) for fact in self.facts()]
        self.write_ledger((fact for fact in told if fact is not None), key)

    def _retold(self, fact: Fact, rows: dict[str, MatchRow]) -> Fact | None:
        if isinstance(fact, Opened):
            return Opened(identity=self.identity)
        if isinstance(fact, Closed):
            return Closed(results=sha256_of(self.out / "results.json"), scores=fact.scores)
        if isinstance(fact, MatchEnded):
            row = rows.get(fact.match)
            if row is None:
                return None
            record = None if row.record is None else sha256_of(self.out / row.record)
            timing = None if record is None else fact.timing
            return fact.model_copy(update={"row": row, "record": record, "timing": timing})
        return fact

    def write_ledger(self, facts: Iterable[Fact], key: SigningKey | None) -> None:
        """Write a ledger anew, with every digest and signature that its writer can make."""
        head, lines = None, []
        for number, fact in enumerate(facts):
            at = "2030-01-01T00:00:00.000+00:00"
            entry = Entry(number=number, previous=head, at=at, fact=fact, signature=None)
            if key is not None:
                entry = entry.model_copy(update={"signature": key.sign(entry.signed)})
            lines.append(entry.line)
            head = digest_of_line(entry.line)
        (self.out / LEDGER_FILE).write_bytes(b"".join(line + b"\n" for line in lines))

    def edit_ledger(self, number: int, change: Callable[[dict[str, object]], None]) -> None:
        """Change one entry in place and leave all others as they are."""
        lines = (self.out / LEDGER_FILE).read_bytes().splitlines()
        content = json.loads(lines[number])
        change(content)
        lines[number] = Entry.model_validate(content).line
        (self.out / LEDGER_FILE).write_bytes(b"".join(line + b"\n" for line in lines))


def copied(out: Path, to: Path) -> Forgery:
    """Return a copy of an evaluation's folder, to be forged."""
    shutil.copytree(out, to)
    return Forgery(to)


def blamed_on_platform(row: MatchRow) -> MatchRow:
    """A match, told as if the platform had failed."""
    return MatchRow(index=row.index, status="failed", fault="platform", detail="no memory left")


def with_metrics(row: MatchRow, metrics: dict[str, float]) -> MatchRow:
    """A match of one seat, told with other metrics."""
    seats: tuple[SeatRow, ...] = tuple(seat.model_copy(update={"metrics": metrics}) for seat in row.seats)
    return row.model_copy(update={"metrics": metrics, "seats": seats})
