"""Several runs at the same time, each in a process of its own."""

import multiprocessing
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import Future, ProcessPoolExecutor, wait
from pathlib import Path
from queue import Empty
from typing import TYPE_CHECKING, Any

from wildscav_training.learning.settings import TrainingSettings

if TYPE_CHECKING:
    from wildscav_training.learning.run import Result

LOOK_EVERY = 0.2  # s between two looks for figures


def train_at_once(
    runs: Sequence[tuple[TrainingSettings, Path]],
    report: Callable[[int, Mapping[str, float]], None],
    *,
    processes: int,
    resume: bool,
    episodes: int,
) -> "list[Result]":
    """Train several policies, some of them at the same time, and return the results in order.

    Args:
        report: Called with the place of a run in ``runs`` and its figures after each of its iterations.

    Raises:
        UserError: A folder or the settings cannot be used.
    """
    context = multiprocessing.get_context("spawn")  # never fork after a kernel ran
    with context.Manager() as manager:
        figures = manager.Queue()
        with ProcessPoolExecutor(processes, context) as executor:
            futures = [
                executor.submit(_train, figures, place, settings, folder, resume=resume, episodes=episodes)
                for place, (settings, folder) in enumerate(runs)
            ]
            try:
                for place, found in _until_done(futures, figures):
                    report(place, found)
            finally:
                executor.shutdown(cancel_futures=True)
    return [future.result() for future in futures]


def _until_done(futures: "list[Future[Result]]", figures: Any) -> Iterator[tuple[int, Mapping[str, float]]]:
    """Yield the figures of all runs as they come, until all have ended or one has failed."""
    pending = set(futures)
    while pending:
        done, pending = wait(pending, timeout=LOOK_EVERY)
        for future in done:
            future.result()  # raises what the run raised
        while True:
            try:
                yield figures.get_nowait()
            except Empty:
                break


def _train(
    figures: Any, place: int, settings: TrainingSettings, folder: Path, *, resume: bool, episodes: int
) -> "Result":
    from wildscav_training.learning.run import train

    def report(found: Mapping[str, float]) -> None:
        figures.put((place, dict(found)))

    return train(settings, folder, report, resume=resume, episodes=episodes)
