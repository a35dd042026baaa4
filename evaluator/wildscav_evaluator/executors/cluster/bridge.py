"""The process that talks to a Ray cluster, so that neither Ray's output nor its end reaches this program.

When a cluster is lost, Ray ends the process that is connected to it, with messages of its own. So that
process is not this program, but a child, whose output goes into a log.
"""

import contextlib
import importlib.util
import os
import signal
import sys
from collections.abc import Callable, Generator, Iterator
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

from wildscav.errors import UserError, WildscavError, describe
from wildscav.system.worker_pool import start_worker
from wildscav.system.worker_processes import become_worker
from wildscav_evaluator.cache import cache_folder
from wildscav_evaluator.executors.base import ExecutorError
from wildscav_evaluator.executors.cluster.messages import Done, Failed, Message, Question, Request

CONNECT_TIME = 60.0  # s to connect to a cluster, at most
STOP_TIME = 15.0  # s for the matches on all nodes to be stopped


class Bridge:
    """A connection to a Ray cluster, through a process of its own. Address and errors: see ``connect``."""

    def __init__(self, address: str | None) -> None:
        self._where = f"the Ray cluster at {address}" if address else "the Ray cluster"
        self._is_lost = False
        self._log = cache_folder("logs") / f"ray-{os.getpid()}.log"
        self._log.parent.mkdir(parents=True, exist_ok=True)
        self._process, self._connection = start_worker(_serve, address, self._log)
        try:
            if not self._connection.poll(CONNECT_TIME):
                raise ExecutorError(f"{self._where} did not answer within {CONNECT_TIME:.0f} s")
            self._receive()
        except BaseException:
            self.close()
            raise

    def request(self, request: Request, answer: Callable[[Any], Any] = lambda _: None) -> Iterator[Message]:
        """Send a request, and yield the messages that answer it, except questions, which ``answer`` answers.

        ExecutorError if it failed, or the cluster was lost.
        """
        self._send(request)
        while not isinstance(message := self._receive(), Done):
            if isinstance(message, Question):
                self._send(answer(message))
            else:
                yield message

    def _send(self, message: object) -> None:
        try:
            self._connection.send(message)
        except OSError:
            raise ExecutorError(self._lost()) from None

    def _receive(self) -> Message:
        try:
            message: Message = self._connection.recv()
        except (EOFError, OSError):
            raise ExecutorError(self._lost()) from None
        if isinstance(message, Failed):
            raise ExecutorError(message.reason)
        return message

    def _lost(self) -> str:
        self._is_lost = True
        return f"{self._where} was lost (what Ray printed: {self._log})"

    def close(self) -> None:
        """Stop everything that runs on the cluster for this program, and disconnect."""
        self._connection.close()
        if self._process.is_alive():
            self._process.terminate()
            self._process.join(STOP_TIME)
        if self._process.is_alive():
            self._process.kill()
            self._process.join()
        if not self._is_lost:
            self._log.unlink(missing_ok=True)


def check_installed() -> None:
    """Refuse to go on without the package ``ray``."""
    if importlib.util.find_spec("ray") is None:
        raise UserError("--executor ray needs the module ray; install it with: pip install 'wildscav[ray]'")


def _serve(connection: Connection, parent: int, address: str | None, log: Path) -> None:
    """Connect to the cluster and carry out requests. Runs in the bridge's process."""
    become_worker(parent)
    descriptor = os.open(log, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o600)
    for stream in (sys.stdout, sys.stderr):
        os.dup2(descriptor, stream.fileno())
    from wildscav_evaluator.executors.cluster.connection import connect

    try:
        connect(address)  # before anything imports Ray, which reads its settings then
    except ExecutorError as error:
        connection.send(Failed(str(error)))
        return
    from wildscav_evaluator.executors.cluster.session import ClusterSession

    signal.signal(signal.SIGTERM, _leave)  # only now, because Ray sets its own
    connection.send(Done())
    with contextlib.closing(ClusterSession()) as session, contextlib.suppress(EOFError, OSError):
        while True:
            _carry_out(connection, session.carry_out(connection.recv()))


def _carry_out(connection: Connection, messages: Generator[Message, Any, None]) -> None:
    """Send the messages of one request, and the answers to their questions back."""
    answer = None
    try:
        while True:
            message = messages.send(answer)
            connection.send(message)
            answer = connection.recv() if isinstance(message, Question) else None
    except StopIteration:
        connection.send(Done())
    except (EOFError, BrokenPipeError):
        raise
    except WildscavError as error:
        connection.send(Failed(str(error)))
    except OSError as error:
        connection.send(Failed(describe(error)))
    except Exception as error:  # noqa: BLE001 - Ray raises whatever its parts raise
        connection.send(
            Failed(f"the Ray cluster failed: {' '.join(f'{type(error).__name__}: {error}'.split())}")
        )
    finally:
        messages.close()


def _leave(number: int, _: object) -> None:
    # Runs every `finally` block on the way out; those stop what runs on the cluster.
    raise SystemExit(128 + number)
