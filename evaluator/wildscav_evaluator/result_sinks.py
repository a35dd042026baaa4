"""Result sinks: where results are stored in addition to the output folder.

Other packages register sinks as entry points.
"""

from collections.abc import Iterator
from importlib.metadata import entry_points
from typing import Protocol

from wildscav_evaluator.output.results import Results
from wildscav_evaluator.tournaments.tournament_file import Tournament

GROUP = "wildscav.result_sinks"


class ResultSink(Protocol):
    """A store for results. It is made with the text of ``--db``."""

    def check(self) -> None:
        """Check, before anything is played, that results can be stored; leave nothing new behind.

        Raises:
            UserError: They cannot be stored.
        """
        ...

    def store_tournament(self, tournament: Tournament, results: Results) -> str:
        """Store the ratings of a tournament, all or nothing, and return a line that says where.

        Raises:
            UserError: They could not be stored.
        """
        ...

    def store(self, evaluations: Results) -> str:
        """Store results, all or nothing, and return a line that says where.

        Raises:
            UserError: They could not be stored.
        """
        ...


def sinks(database: str) -> Iterator[ResultSink]:
    """Make every sink whose dependencies are installed, and check that results can be stored in it.

    Raises:
        UserError: They cannot be stored.
    """
    for entry_point in entry_points(group=GROUP):
        try:
            made = entry_point.load()
        except ModuleNotFoundError:
            continue  # its extra is not installed
        sink: ResultSink = made(database)
        sink.check()
        yield sink
