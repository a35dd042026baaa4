"""Episodes of records: each is played again exactly, while the chosen seats are watched."""

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from wildscav.errors import UserError
from wildscav_engine.envs.settings.config import EnvConfig, read_config
from wildscav_engine.envs.spaces.actions import ActionError
from wildscav_engine.maps import GENERATOR_VERSION, MapError, map_of
from wildscav_engine.record import Record, RecordError, read_record
from wildscav_engine.simulation.batch import Batch
from wildscav_engine.simulation.setup.match_setup import MatchSetupError
from wildscav_engine.specs.match_spec import SUBMISSION, MatchSpec
from wildscav_engine.version import SIMULATION_VERSION, advice
from wildscav_training.datasets.episodes import Episode, Spaces, Watcher, spaces_of

# The options of an environment that say what learners see, do and get; the record says all others.
OPTIONS = ("version", "flat", "sensors", "rewards", "action_mode")
SAME = ("track", "frames_per_action")  # what all records of a data set share


class RecordedEpisodes:
    """The episodes of some records.

    Attributes:
        spaces: Of the observations and actions.
        config: The environment of the first record's episodes.
        count: The number of matches.
    """

    def __init__(
        self,
        records: Sequence[Path],
        options: Mapping[str, Any],
        *,
        seats: Sequence[int] = (),
        names: Sequence[str] = (),
        together: bool = False,
    ) -> None:
        """Read the first record, which decides about the spaces.

        Args:
            options: Options of the environment, some of ``OPTIONS``.
            seats: The seats to take; none for all that submissions fill.
            names: The display names of the agents to take; none for all.

        Raises:
            UserError: It cannot be read, an option is wrong, or there is no such seat.
        """
        for name in options:
            if name not in OPTIONS:
                raise UserError(
                    f"--option {name} is decided by the records; to choose are {', '.join(OPTIONS)}", 2
                )
        self._records, self._options = list(records), dict(options)
        self._seats, self._names, self._together = tuple(seats), tuple(names), together
        self._first = _read(self._records[0])
        self.count = len(self._records)
        self.config = self._config(self._records[0], self._first)
        self.spaces = spaces_of(self.config, together=together)

    def __iter__(self) -> Iterator[list[Episode]]:
        """Yield the episodes of each record in turn.

        Raises:
            UserError: A record cannot be read or does not hold, or is of another kind than the first.
        """
        for path in self._records:
            record = _read(path)
            config = self._config(path, record)
            self._check_kind(path, record.spec, spaces_of(config, together=self._together))
            watcher = self._watched(path, record, config)
            about = {"record": path.name, "match_seed": str(record.spec.seed)}
            episodes = [watcher.together(about)] if self._together else watcher.alone(about)
            yield [_named(episode, record.names) for episode in episodes]

    def _config(self, path: Path, record: Record) -> EnvConfig:
        """Return an environment whose learners observe what the chosen seats of a record did."""
        spec, seats = record.spec, self._chosen(path, record)
        order = seats + [seat for seat in range(len(spec.seats)) if seat not in seats]
        given = {name: getattr(spec, name) for name in ("map", "rules", "supplies", "supply_goal", "zone")}
        given |= {name: getattr(spec, name) for name in ("time_limit", "frames_per_action")}
        given |= {
            "agents": len(seats),
            "opponents": tuple(spec.seats[seat] for seat in order[len(seats) :]),
            "teams": tuple(spec.team_of_seats[seat] for seat in order),
        }
        try:
            return read_config(spec.track, {**self._options, **given})
        except (TypeError, ValueError) as error:
            raise UserError(f"the options of the environment: {error}", exit_code=2) from None

    def _chosen(self, path: Path, record: Record) -> list[int]:
        """Return the seats of a record to watch, in ascending order."""
        filled = [seat for seat, entry in enumerate(record.spec.seats) if entry == SUBMISSION]
        seats = sorted(set(self._seats)) if self._seats else filled
        if wrong := [seat for seat in seats if seat >= len(record.names)]:
            raise UserError(f"{path} has no seat {wrong[0]}; its seats are 0 to {len(record.names) - 1}", 2)
        if self._names:
            seats = [seat for seat in seats if record.names[seat] in self._names]
        if not seats:
            there = ", ".join(dict.fromkeys(record.names))
            what = f"named {' or '.join(self._names)}" if self._names else "that a submission fills"
            raise UserError(f"{path} has no seat {what}; choose with --seat, or --name among {there}", 2)
        return seats

    def _check_kind(self, path: Path, spec: MatchSpec, spaces: Spaces) -> None:
        """Compare a record with the first."""
        first = self._first.spec
        for name in SAME:
            here, there = getattr(spec, name), getattr(first, name)
            if here != there:
                raise UserError(
                    f"{path} has {name} {here}, but {self._records[0]} has {there}: make a data set of each",
                    exit_code=2,
                )
        if spaces != self.spaces:
            raise UserError(
                f"{path} has other observations or another number of seats than {self._records[0]}: choose "
                "seats with --seat or --name, or sensors with --option sensors=…",
                exit_code=2,
            )

    def _watched(self, path: Path, record: Record, config: EnvConfig) -> Watcher:
        """Play a record again, and return who has watched it."""
        _check_versions(path, record)
        try:
            batch = Batch([record.spec], [map_of(record.spec.map)])
        except (MapError, MatchSetupError) as error:
            raise UserError(f"{path}: the match cannot be set up: {error}") from None
        watcher = Watcher(config, batch, self._chosen(path, record))
        for step, (actions, digest) in enumerate(zip(record.actions, record.digests, strict=True), start=1):
            try:
                watcher.step(actions)
            except ActionError as error:
                raise UserError(f"{path}: step {step}: {error}") from None
            if batch.state.matches.digest[0] != digest:
                raise UserError(f"{path} does not hold: step {step} differs; see wildscav verify")
        if not record.steps:
            raise UserError(f"{path} has no steps")
        return watcher


def _read(path: Path) -> Record:
    """Read a record."""
    try:
        return read_record(path)
    except RecordError as error:
        raise UserError(str(error)) from None


def _check_versions(path: Path, record: Record) -> None:
    """Refuse a record of an engine whose matches or maps are others."""
    for what, then, now in (
        ("simulation", record.simulation_version, SIMULATION_VERSION),
        ("generator", record.generator_version, GENERATOR_VERSION),
    ):
        if then != now:
            raise UserError(
                f"{path} was played with {what} version {then}, but this engine has version {now}: "
                f"{advice(record.engine_version)}"
            )


def _named(episode: Episode, names: Sequence[str]) -> Episode:
    return episode._replace(about={**episode.about, "agent": names[episode.about["seat"]]})
