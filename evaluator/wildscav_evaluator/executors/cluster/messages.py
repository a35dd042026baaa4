"""The messages between this program and the process that talks to the cluster (``bridge.py``).

A request is answered by messages, of which the last is ``Done`` or ``Failed``. A ``Question`` among them
waits for an answer, so the two sides never write at the same time.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from wildscav_evaluator.executors.base import Examined, Node
from wildscav_evaluator.matches.jobs import Job, JobEvent
from wildscav_evaluator.output.results import MatchRow, MatchTiming


@dataclass(frozen=True)
class Examine:
    """The request to examine all nodes of the cluster; its answer is ``Examined``."""

    sandboxes: tuple[str, ...]  # the names of those to try on each node
    images: tuple[str, ...] = ()  # container images that a node must have


@dataclass(frozen=True)
class Use:
    """The request to give work only to nodes that keep the promises of a sandbox."""

    sandbox: str


@dataclass(frozen=True)
class Prepare:
    """The request to bring submissions to the cluster and to compile the engine on its first node."""

    jobs: tuple[Job, ...]
    at_once: int


@dataclass(frozen=True)
class Play:
    """The request to play the jobs of the last ``Prepare``."""


@dataclass(frozen=True)
class Call:
    """The request to call a function with items, which are asked for one by one."""

    function: Callable[[Any], Any]
    at_once: int


Request = Examine | Use | Prepare | Play | Call


class Question:
    """A message that waits for an answer."""


@dataclass(frozen=True)
class Starting(Question):
    """A match is about to start. The answer: files of an earlier run that it needs, by their paths, or None.

    None leaves the match out.
    """

    number: int  # of its job


@dataclass(frozen=True)
class NextItem(Question):
    """There is room for another item. The answer: a tuple with the item, or an empty one after the last."""


@dataclass(frozen=True)
class Played:
    """A match that was played on a node, or given up there, with its files."""

    row: MatchRow
    timing: MatchTiming | None
    replay_error: str
    files: Mapping[str, bytes]  # by their paths in the output folder


@dataclass(frozen=True)
class Happened:
    """A match made progress, or an attempt at it failed."""

    number: int  # of its job
    event: JobEvent


@dataclass(frozen=True)
class MatchEnded:
    """A match ended."""

    number: int  # of its job
    played: Played


@dataclass(frozen=True)
class Returned:
    """The value of a function for an item."""

    number: int  # of the item
    value: Any


@dataclass(frozen=True)
class Nodes:
    """The nodes as they are now."""

    nodes: tuple[Node, ...]


@dataclass(frozen=True)
class Failed:
    """The request failed."""

    reason: str  # in one line


@dataclass(frozen=True)
class Done:
    """The request was carried out."""


Message = Question | tuple[Examined, ...] | Happened | MatchEnded | Returned | Nodes | Failed | Done
