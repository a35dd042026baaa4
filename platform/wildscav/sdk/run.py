"""Play one match with an agent."""

import asyncio
import contextlib
import os
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, TypeVar, cast

from wildscav.agent import Agent, check_action
from wildscav.errors import AgentError, UserError
from wildscav.sdk.watchdog import StepWatchdog, end_watch

if TYPE_CHECKING:
    from wildscav.proto.match_pb2 import MatchOver

Result = TypeVar("Result")
ADDRESS_VARIABLE = "WILDSCAV_ADDRESS"
TOKEN_VARIABLE = "WILDSCAV_TOKEN"  # noqa: S105 - the name of a variable, no secret


def run(agent_class_or_factory: Callable[[], Agent]) -> None:
    """Play one match, and return when it is over.

    The server's address and the seat's token come from the environment: ``WILDSCAV_ADDRESS`` (``host:port``
    or ``unix:/path``) and ``WILDSCAV_TOKEN``; for TLS, also ``WILDSCAV_CA``, and ``WILDSCAV_CERT`` and
    ``WILDSCAV_KEY`` where the server asks for a client's certificate. From then on the process runs as
    ``SCHED_BATCH``, where there is such a policy and no other one was chosen.

    Args:
        agent_class_or_factory: A subclass of ``Agent``, or anything that makes an agent when called.

    Raises:
        UserError: Address or token is missing, or a certificate cannot be read.
        AgentError: The agent answers with something else than an action.
        ServerUnreachableError: No server answers, or the connection was lost.
        RefusedError: The server does not give the seat.
    """
    address, token = _from_environment(ADDRESS_VARIABLE), _from_environment(TOKEN_VARIABLE)
    # The agent is made before the seat is taken: what cannot be made cannot play.
    agent = make_agent(agent_class_or_factory)
    play(agent, address, token)


def _from_environment(name: str) -> str:
    value = os.environ.get(name, "")
    if not value:
        raise UserError(
            f"{name} is not set: an agent is started by a match's host, for instance `wildscav play FOLDER`",
            exit_code=2,
        )
    return value


def make_agent(factory: Callable[[], Agent]) -> Agent:
    """Make an agent.

    Raises:
        AgentError: What comes out has no ``act`` or no ``reset``.
    """
    agent = factory()
    for method in ("reset", "act"):
        if not callable(getattr(agent, method, None)):
            name = getattr(factory, "__name__", repr(factory))
            raise AgentError(f"{name} has no method {method}(): an agent is a subclass of wildscav.Agent")
    return agent


def play(agent: Agent, address: str, token: str) -> "MatchOver":
    """Play one match with an agent that has been made, and return how it ended."""
    use_batch_scheduling()
    # A loop of its own, which an agent that asks for the current one does not get.
    with asyncio.Runner(loop_factory=asyncio.new_event_loop) as runner:
        return runner.get_loop().run_until_complete(_play(agent, address, token))


def use_batch_scheduling() -> None:
    """Have this thread, and what it starts from now on, not preempt others when it is woken (Linux).

    Agents are woken all at once, each for a moment. Where ten share two cores with the server, a match plays
    a tenth to a fifth more steps a second if each waits until whoever is at work has done its part.
    """
    if hasattr(os, "SCHED_BATCH"):
        with contextlib.suppress(OSError):  # a policy is a kindness: where it is not to be had, do without
            if os.sched_getscheduler(0) == os.SCHED_OTHER:
                os.sched_setscheduler(0, os.SCHED_BATCH, os.sched_param(0))


async def _play(agent: Agent, address: str, token: str) -> "MatchOver":
    # Imported here because the command line, which imports this package, should start quickly.
    from wildscav.sdk.connection import Connection
    from wildscav.sdk.credentials import Credentials
    from wildscav.version import __version__

    outside = OutsideEventLoop()
    async with Connection(address, token, __version__, Credentials.of()) as connection:
        outside.call(agent.reset, connection.match)
        end_watch()  # of the start
        observation = await connection.first()
        watch = StepWatchdog(connection.match)
        watching = asyncio.create_task(watch.run())
        try:
            while observation is not None:
                watch.observation = observation
                action = check_action(agent, outside.call(agent.act, observation))
                observation = await connection.answer(observation.step, action)
        finally:
            watching.cancel()
        return connection.over


class OutsideEventLoop:
    """Calls an agent's code as if no event loop ran, so that it may run loops of its own.

    Made by the task that plays the match. To stop the connection's loop for each call and to start it again
    would take a sixth of a whole step. Python from 3.14 on knows one current task a thread, not one a loop,
    so the task has to be left as well.
    """

    def __init__(self) -> None:
        self._loop = asyncio.get_running_loop()
        self._task = cast(asyncio.Task[Any], asyncio.current_task())

    def call(self, work: Callable[..., Result], argument: object) -> Result:
        """Call something of the agent's."""
        asyncio._leave_task(self._loop, self._task)  # noqa: SLF001 - both are documented for who extends asyncio
        asyncio._set_running_loop(None)  # noqa: SLF001
        try:
            return work(argument)
        finally:
            asyncio._set_running_loop(self._loop)  # noqa: SLF001
            asyncio._enter_task(self._loop, self._task)  # noqa: SLF001
