"""The league: keeps past selves and chooses opponents among them by prioritized fictitious self-play."""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from random import Random
from typing import Any

from pydantic import ValidationError

from wildscav_engine.envs.league.table import (
    LeagueError,
    LeagueSettings,
    LeagueTable,
    Results,
    Weighting,
    priorities,
)
from wildscav_engine.envs.settings.players import Player, PolicyOpponent, Sampler, read_player
from wildscav_engine.specs.validation import one_line
from wildscav_engine.storage.files import read_limited, write_whole

Factory = Callable[[Any], Any]
LARGEST_TABLE = 10_000_000  # bytes


class League(Sampler):
    """Past selves and robots, each chosen the more often the worse the learner does against it.

    Name it in ``opponents`` of an environment, once for each seat: ``opponents=(league,) * 3``. Every
    episode then has opponents of its own, which depend on the seed of its match and on the results so far. At
    the end of an episode, the environment records the result against each of them.

    A past self stays until ``capacity`` is exceeded. Then the one that the learner beats most reliably is
    dropped, the oldest of several; the newest always stays.
    """

    def __init__(
        self,
        *,
        robots: Sequence[str] = (),
        factory: Factory | None = None,
        weighting: Weighting = "hard",
        power: float = 2.0,
        latest_share: float = 0.3,
        robot_share: float = 0.2,
        capacity: int = 32,
        memory: float = 0.98,
    ) -> None:
        """Create a league without past selves.

        Args:
            robots: The names of robots among the opponents.
            factory: Makes a policy from parameters; None: ``add`` takes policies.
            weighting: How the win rate p determines the choice: "hard" by (1 - p) to the power, "variance" by
                p (1 - p), "uniform" by nothing.
            power: The power for "hard"; with a higher one, the strongest opponents are chosen more often.
            latest_share: The share of seats that the newest past self fills, 0 to 1.
            robot_share: The share of seats that robots fill, 0 to 1; all before the first past self.
            capacity: The maximum number of past selves.
            memory: The weight that earlier results keep with each new one, because the learner changes; 0.98
                makes about the last 50 count.

        Raises:
            LeagueError: An argument is invalid.
        """
        try:
            self.settings = LeagueSettings(
                weighting=weighting,
                power=power,
                latest_share=latest_share,
                robot_share=robot_share,
                capacity=capacity,
                memory=memory,
            )
        except ValidationError as error:
            raise LeagueError(one_line(error)) from None
        if self.settings.latest_share + self.settings.robot_share > 1.0:
            raise LeagueError(
                f"latest_share and robot_share are {latest_share} and {robot_share}, "
                "must be at most 1 together"
            )
        self._factory = factory
        self._robots = {_checked_robot(name): Results(name=name) for name in robots}
        self._members: dict[str, Results] = {}  # oldest first
        self._players: dict[str, Player] = {}
        self._sources: dict[str, Any] = {}  # what was added
        self._added = 0

    # Its members.

    def add(self, policy: Any, name: str | None = None) -> str:
        """Add a past self, and return its name.

        Args:
            policy: A policy that does not change any more, or parameters if the league has a factory. A
                learner that goes on learning has to be copied.
            name: Its name; by default ``self-1``, ``self-2`` and so on.

        Raises:
            LeagueError: There is one of this name already.
            ValueError: The policy cannot play.
        """
        chosen = f"self-{self._added + 1}" if name is None else name
        if chosen in self._members or chosen in self._robots:
            raise LeagueError(f"the league already has {chosen!r}; names must differ")
        self._enter(chosen, policy, Results(name=chosen))
        self._added += 1
        if len(self._members) > self.settings.capacity:
            self._drop(max(list(self._members.values())[:-1], key=lambda each: each.win_rate).name)
        return chosen

    def add_robot(self, name: str) -> None:
        """Add a robot, for instance a stronger one when the learner beats the others, or raise ValueError."""
        if name in self.results:
            raise LeagueError(f"the league already has {name!r}; names must differ")
        self._robots[_checked_robot(name)] = Results(name=name)

    def _enter(self, name: str, source: Any, results: Results) -> None:
        policy = source if self._factory is None else self._factory(source)
        player = read_player(policy)
        if isinstance(player, str):
            raise LeagueError(f"{player!r} is a robot: name it in robots=… when you create the league")
        if isinstance(player, PolicyOpponent):
            player = PolicyOpponent(player.policy, name, player.sensors, player.flat, player.action_mode)
        self._players[name], self._sources[name], self._members[name] = player, source, results

    def _drop(self, name: str) -> None:
        for table in (self._members, self._players, self._sources):
            table.pop(name)

    @property
    def sources(self) -> Mapping[str, Any]:
        """What was added under each name: policies, or parameters if the league has a factory."""
        return dict(self._sources)

    @property
    def results(self) -> Mapping[str, Results]:
        """The results against each past self, oldest first, and then against each robot."""
        return self._members | self._robots

    # Its choices.

    def probabilities(self) -> dict[str, float]:
        """Return the probability of each opponent to fill a seat in the next episode.

        Raises:
            LeagueError: The league is empty.
        """
        if not self._members and not self._robots:
            raise LeagueError("the league is empty: add a policy, or give it robots")
        latest = self.settings.latest_share if self._members else 0.0
        robots = (self.settings.robot_share if self._members else 1.0) if self._robots else 0.0
        found = self._shared(self._members, max(0.0, 1.0 - latest - robots)) | self._shared(
            self._robots, robots
        )
        if self._members:
            found[next(reversed(self._members))] += latest
        return found

    def _shared(self, table: Mapping[str, Results], share: float) -> dict[str, float]:
        """Return the probabilities of the opponents in a table, which have a share together."""
        if not table:
            return {}
        chances = priorities(list(table.values()), self.settings)
        return {name: share * chance for name, chance in zip(table, chances, strict=True)}

    def sample(self, seats: int, random: Random) -> list[Player]:
        """Return who fills some seats, each drawn independently; see ``Sampler``."""
        chances = self.probabilities()
        drawn = random.choices(list(chances), list(chances.values()), k=seats)
        return [self.member(name) for name in drawn]

    def member(self, name: str) -> Player:
        """Return an opponent by its name; LookupError if there is none."""
        if name in self._robots:
            return name
        if name not in self._players:
            raise LookupError(f"the league has no {name!r}; it has {', '.join(self.results) or 'nobody'}")
        return self._players[name]

    def record(self, name: str, result: float) -> None:
        """Record the result of a game against an opponent; of one that was dropped, it is ignored.

        Environments call this at the end of each episode, except of one that continued from a saved state.

        Args:
            name: The opponent's name.
            result: 1 if the learner won, 0.5 for a draw, 0 if it lost.

        Raises:
            LeagueError: The result is none of these.
        """
        if result not in (0.0, 0.5, 1.0):
            raise LeagueError(f"the result is {result!r}, must be 0, 0.5 or 1")
        for table in (self._members, self._robots):
            if name in table:
                table[name] = table[name].with_result(float(result), self.settings.memory)

    # Its table.

    def save(self, path: str | Path) -> None:
        """Write the settings and results as JSON, whole or not at all. Policies are not included.

        Raises:
            OSError: The file cannot be written; an older one stays as it is.
        """
        write_whole(Path(path), self.table.model_dump_json(indent=1).encode() + b"\n")

    @property
    def table(self) -> LeagueTable:
        """Everything in the league but its policies."""
        return LeagueTable(
            settings=self.settings,
            added=self._added,
            members=tuple(self._members.values()),
            robots=tuple(self._robots.values()),
        )

    @classmethod
    def load(
        cls, path: str | Path, sources: Mapping[str, Any], *, factory: Factory | None = None
    ) -> "League":
        """Return the league of a file that ``save`` wrote.

        Args:
            path: The file.
            sources: The policies by name, or their parameters if there is a factory, as ``sources`` of the
                league that was saved.
            factory: As for a new league.

        Raises:
            LeagueError: The file is not a table of a league, or a policy is missing.
            OSError: The file cannot be read.
        """
        try:
            table = LeagueTable.model_validate_json(read_limited(Path(path), LARGEST_TABLE))
        except ValidationError as error:
            raise LeagueError(f"{path} is not the table of a league: {one_line(error)}") from None
        return cls.of(table, sources, factory=factory)

    @classmethod
    def of(
        cls, table: LeagueTable, sources: Mapping[str, Any], *, factory: Factory | None = None
    ) -> "League":
        """Return the league of a table; arguments and errors are those of ``load``."""
        league = cls(
            robots=[each.name for each in table.robots], factory=factory, **table.settings.model_dump()
        )
        missing = [each.name for each in table.members if each.name not in sources]
        if missing:
            raise LeagueError(f"the table lists {', '.join(missing)}, which sources does not contain")
        for each in table.members:
            league._enter(each.name, sources[each.name], each)
        league._robots = {each.name: each for each in table.robots}
        league._added = table.added
        return league


def _checked_robot(name: str) -> str:
    player = read_player(name)
    if not isinstance(player, str):
        raise LeagueError(f"{name!r} is not the name of a robot")
    return player
