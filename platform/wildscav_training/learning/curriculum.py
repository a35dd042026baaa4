"""A curriculum: starts near the target first, and farther away as the learner succeeds."""

from collections import deque
from collections.abc import Sequence
from typing import Any

NEEDED = 0.8  # share of successes that opens the next stage
WINDOW = 128  # episodes that it is measured on


class Curriculum:
    """The stages of a run, each with a start range; the last has none, and is the task itself.

    Successes end sooner than failures do, so the first episodes that end after a change are the lucky ones.
    The share is therefore measured only when a whole window of episodes has ended in the stage.
    """

    def __init__(self, ranges: Sequence[float] = ()) -> None:
        """Begin with the first stage.

        Args:
            ranges: m, the start range of each stage but the last.
        """
        self._ranges = (*ranges, None)
        self.stage = 0
        self._results: deque[float] = deque(maxlen=WINDOW)

    @property
    def start_range(self) -> float | None:
        """The farthest start from the target in the present stage, m; None for any distance."""
        return self._ranges[self.stage]

    def record(self, results: Sequence[float]) -> None:
        """Receive the successes, 1 or 0, of episodes that have ended."""
        self._results.extend(results)

    def advance(self) -> bool:
        """Go on to the next stage if the learner is ready for it, and return whether that is so."""
        is_last = self.stage == len(self._ranges) - 1
        if is_last or len(self._results) < WINDOW or sum(self._results) < NEEDED * WINDOW:
            return False
        self.stage += 1
        self._results.clear()
        return True

    def state(self) -> dict[str, Any]:
        """Return the state for a checkpoint."""
        return {"stage": self.stage, "results": list(self._results)}

    def restore(self, state: dict[str, Any]) -> None:
        """Continue from what ``state`` returned."""
        self.stage = int(state["stage"])
        self._results = deque(state["results"], maxlen=WINDOW)
