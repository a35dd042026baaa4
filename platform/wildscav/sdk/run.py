"""Play one match with an agent."""

import asyncio
import contextlib
import os
from collections.abc import Callable
from importlib import import_module
from typing import TYPE_CHECKING, Any, TypeVar, cast

from wildscav.agent import Agent, check_action
from wildscav.errors import AgentError, UserError
from wildscav.notes import begin_step
from wildscav.sdk.watchdog import StepWatchdog, end_watch

if TYPE_CHECKING:
    from wildscav.proto.match_pb2 import MatchOver

Result = TypeVar("Result")
ADDRESS_VARIABLE = "WILDSCAV_ADDRESS"
TOKEN_VARIABLE = "WILDSCAV_TOKEN"  # noqa: S105 - the name of a variable, no secret
INTERFACE_VARIABLE = "WILDSCAV_INTERFACE"
# By interface: the module, and its classes of a seat and of those who play it.
BRIDGED = {
    "words": ("wildscav.words", "WordsSeat", "WordsPlayer"),
    "keys": ("wildscav.keyboard", "KeysSeat", "KeysPlayer"),
}


def run(agent_class_or_factory: Callable[[], object]) -> None:
    """Play one match, and return when it is over.

    The server's address and the seat's token come from the environment: ``WILDSCAV_ADDRESS`` (``host:port``
    or ``unix:/path``) and ``WILDSCAV_TOKEN``; for TLS, also ``WILDSCAV_CA``, and ``WILDSCAV_CERT`` and
    ``WILDSCAV_KEY`` if the server requires a client's certificate. For a seat that plays by words or keys,
    ``WILDSCAV_INTERFACE`` says so, and the address is that of its bridge. On Linux the process changes its
    scheduling policy to ``SCHED_BATCH``, unless another policy than the default was chosen.

    Args:
        agent_class_or_factory: A subclass of ``Agent``, ``WordsPlayer`` or ``KeysPlayer``, or a function that
            returns an agent.

    Raises:
        UserError: Address or token is missing, or a certificate cannot be read.
        AgentError: The agent returns something that is not an action.
        ServerUnreachableError: No server answers, or the connection was lost.
        RefusedError: The server refuses the seat.
    """
    address, token = _from_environment(ADDRESS_VARIABLE), _from_environment(TOKEN_VARIABLE)
    interface = os.environ.get(INTERFACE_VARIABLE, "numbers")
    # The agent is made before the seat is taken, so that one that cannot be made takes no seat.
    if interface == "numbers":
        play(make_agent(agent_class_or_factory), address, token)
    else:
        use_batch_scheduling()
        play_at_bridge(interface, agent_class_or_factory, address, token)


def _from_environment(name: str) -> str:
    value = os.environ.get(name, "")
    if not value:
        raise UserError(
            f"{name} is not set: a match's host starts the agents, for instance `wildscav play FOLDER`",
            exit_code=2,
        )
    return value


def make_agent(factory: Callable[[], object]) -> Agent:
    """Make an agent, or raise an AgentError if the object has no ``act`` or no ``reset``."""
    agent: Any = factory()
    for method in ("reset", "act"):
        if not callable(getattr(agent, method, None)):
            name = getattr(factory, "__name__", repr(factory))
            raise AgentError(
                f"{name} has no method {method}(): an agent is a subclass of wildscav.Agent; one that plays "
                "by words or keys needs a bridge, as `wildscav play` and evaluations have it"
            )
    made: Agent = agent
    return made


def play(agent: Agent, address: str, token: str) -> "MatchOver":
    """Play one match with an agent, and return its result."""
    use_batch_scheduling()
    # A separate loop, which is not the current one for the agent's code.
    with asyncio.Runner(loop_factory=asyncio.new_event_loop) as runner:
        return runner.get_loop().run_until_complete(_play(agent, address, token))


def play_at_bridge(interface: str, factory: Callable[[], object], address: str, token: str) -> None:
    """Play one match by an interface.

    Raises:
        UserError: There is no such interface.
        AgentError: The player is none of the interface, or the bridge refuses a request.
        ServerUnreachableError: No bridge answers, or the connection was lost.
    """
    if interface not in BRIDGED:
        names = ", ".join(("numbers", *BRIDGED))
        raise UserError(f"there is no interface {interface!r}; the interfaces are {names}", exit_code=2)
    module_name, seat_name, player_name = BRIDGED[interface]
    module = import_module(module_name)
    player = factory()
    if not isinstance(player, getattr(module, player_name)):
        raise AgentError(
            f"{getattr(factory, '__name__', repr(factory))} must be a subclass of "
            f'{module_name}.{player_name}, because its submission.toml says interface = "{interface}"'
        )
    with getattr(module, seat_name)(address, token) as seat:
        end_watch()  # of the start
        player.play(seat)


def use_batch_scheduling() -> None:
    """Make this thread, and threads and processes that it starts, not preempt others on wake-up (Linux).

    All agents are woken at once, each for a short time. Where ten of them share two cores with the server, a
    match plays a tenth to a fifth more steps per second if each waits until the running process is done.
    """
    if hasattr(os, "SCHED_BATCH"):
        with contextlib.suppress(OSError):  # it is an optimization: where it is not allowed, do without
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
                begin_step(observation.step)
                action = check_action(agent, outside.call(agent.act, observation))
                observation = await connection.answer(observation.step, action)
        finally:
            watching.cancel()
            begin_step(None)
        return connection.over


class OutsideEventLoop:
    """Calls an agent's code as if no event loop were running, so that it may run loops of its own.

    It is constructed in the task that plays the match. Stopping and restarting the connection's loop for
    each call would take a sixth of a whole step. Since Python 3.14, the current task belongs to the thread
    and not to the loop, so the task has to be left as well.
    """

    def __init__(self) -> None:
        self._loop = asyncio.get_running_loop()
        self._task = cast(asyncio.Task[Any], asyncio.current_task())

    def call(self, work: Callable[..., Result], argument: object) -> Result:
        """Call a method of the agent."""
        asyncio._leave_task(self._loop, self._task)  # noqa: SLF001 - documented for extensions of asyncio
        asyncio._set_running_loop(None)  # noqa: SLF001
        try:
            return work(argument)
        finally:
            asyncio._set_running_loop(self._loop)  # noqa: SLF001
            asyncio._enter_task(self._loop, self._task)  # noqa: SLF001
