"""Play one match with an agent."""

import asyncio
import os
from collections.abc import Callable
from typing import TYPE_CHECKING, TypeVar

from wildscav.errors import AgentError, UserError
from wildscav.sdk.agent import Agent, check_action

if TYPE_CHECKING:
    from wildscav.proto.match_pb2 import MatchOver

Result = TypeVar("Result")
ADDRESS_VARIABLE = "WILDSCAV_ADDRESS"
TOKEN_VARIABLE = "WILDSCAV_TOKEN"  # noqa: S105 - the name of a variable, no secret


def run(agent_class_or_factory: Callable[[], Agent]) -> None:
    """Play one match, and return when it is over.

    The server's address and the seat's token come from the environment: ``WILDSCAV_ADDRESS`` (``host:port``
    or ``unix:/path``) and ``WILDSCAV_TOKEN``.

    Args:
        agent_class_or_factory: A subclass of ``Agent``, or anything that makes an agent when called.

    Raises:
        UserError: Address or token is missing.
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
    # A loop of its own, which an agent that asks for the current one does not get.
    with asyncio.Runner(loop_factory=asyncio.new_event_loop) as runner:
        return runner.get_loop().run_until_complete(_play(agent, address, token))


async def _play(agent: Agent, address: str, token: str) -> "MatchOver":
    # Imported here because the command line, which imports this package, should start quickly.
    from wildscav import __version__
    from wildscav.sdk.connection import Connection

    async with Connection(address, token, __version__) as connection:
        undisturbed(agent.reset, connection.match)
        observation = await connection.first()
        while observation is not None:
            action = check_action(agent, undisturbed(agent.act, observation))
            observation = await connection.answer(observation.step, action)
        return connection.over


def undisturbed(work: Callable[..., Result], *arguments: object) -> Result:
    """Call an agent's code as if no event loop ran, so that it may run loops of its own.

    To stop the connection's loop for it and to start it again would take a sixth of a whole step.
    """
    loop, task = asyncio.get_running_loop(), asyncio.current_task()
    if task is None:
        raise RuntimeError("a match is played by a task")
    asyncio._leave_task(loop, task)  # noqa: SLF001 - both are documented for who extends asyncio
    asyncio._set_running_loop(None)  # noqa: SLF001
    try:
        return work(*arguments)
    finally:
        asyncio._set_running_loop(loop)  # noqa: SLF001
        asyncio._enter_task(loop, task)  # noqa: SLF001
