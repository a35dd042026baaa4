"""Result sinks: where results go besides the output folder. Other packages plug in by entry point."""

from collections.abc import Iterator
from importlib.metadata import entry_points
from typing import Protocol

from wildscav_evaluator.output.results import Results

GROUP = "wildscav.result_sinks"


class ResultSink(Protocol):
    """A place that keeps results. Made with the text of ``--db``."""

    def check(self) -> None:
        """See, before anything is played, whether results can be kept; leave nothing behind that is new.

        Raises:
            UserError: They cannot.
        """
        ...

    def store(self, evaluations: Results) -> str:
        """Keep results, all or nothing, and return a line that says where.

        Raises:
            UserError: They could not be kept.
        """
        ...


def sinks(database: str) -> Iterator[ResultSink]:
    """Make every sink that is installed with all that it needs; there may be none."""
    for entry_point in entry_points(group=GROUP):
        try:
            made = entry_point.load()
        except ModuleNotFoundError:
            continue  # its extra was not asked for
        sink: ResultSink = made(database)
        yield sink
