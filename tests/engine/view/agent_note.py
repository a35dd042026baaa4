"""What the platform reads from the logs of agents."""

from typing import NamedTuple


class AgentNote(NamedTuple):
    seat: int
    step: int
    text: str = ""
    name: str = ""
    points: tuple[tuple[float, float, float], ...] = ()
    value: float | None = None
