"""An engine that does nothing: it always sends the client the same message, of the real engine's size."""

import sys

from wildscav_legacy.channel import Client
from wildscav_legacy.commander_pb2 import AgentCommand, GameState, GMCommand, Request
from wildscav_legacy.episode import read_episode
from wildscav_legacy.program import read_address
from wildscav_legacy.request_messages import START, Requests
from wildscav_legacy.session import match_of, read_actions

WARM_UP = 20  # steps of the real match after which its observations are taken


def observations(command: GMCommand) -> bytes:
    """Return the message that the real engine sends in the middle of an episode."""
    episode = read_episode(command)
    match = match_of(episode)
    commands = [AgentCommand(id=agent, walk_dir=36 * agent, walk_speed=5) for agent in episode.ids]
    rows, _ = read_actions(commands, {agent: seat for seat, agent in enumerate(episode.ids)})
    for _ in range(min(WARM_UP, match.spec.step_limit // 2)):
        match.step(rows)
    return Requests(match, episode).next()


def main() -> None:
    """Serve one client."""
    client = Client(read_address(sys.argv[1:]))
    reply = client.ask(START)
    while reply.game_state == GameState.RESET:
        told = observations(reply.gm_cmd)
        for _ in range(10 * reply.gm_cmd.timeout):
            client.ask(told)
        # A later field of a message replaces an earlier one of the same number.
        reply = client.ask(told + Request(game_state=GameState.OVER).SerializeToString())


if __name__ == "__main__":
    main()
