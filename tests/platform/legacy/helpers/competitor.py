"""A client of version 1.0.0 of the original's contract, as its table says: a server that the engine calls."""

from collections.abc import Mapping
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from queue import Queue
from typing import Any

import grpc

from wildscav_legacy.commander_pb2 import AgentCommand, GameState, GMCommand, Observation, Reply, Request

PATIENCE = 60.0  # s


class Competitor:
    """Waits for an engine and tells it what to do, as ``Game`` of the original does."""

    def __init__(self) -> None:
        self.requests: Queue[Request] = Queue()
        self._replies: Queue[Reply] = Queue()
        self.latest = Request()
        self.records = Path()  # where its engine writes them
        self._server = grpc.server(ThreadPoolExecutor(2))
        handler = grpc.unary_unary_rpc_method_handler(
            self._answer, request_deserializer=Request.FromString, response_serializer=Reply.SerializeToString
        )
        # The name of the service and of its method are the original's.
        handlers = {"Request_S2A_UpdateGame": handler}
        self._server.add_generic_rpc_handlers(
            (grpc.method_handlers_generic_handler("fps_command.Commander", handlers),)
        )
        self.port = self._server.add_insecure_port("127.0.0.1:0")
        self._server.start()

    def _answer(self, request: Request, context: grpc.ServicerContext) -> Reply:
        self.requests.put(request)
        return self._replies.get()

    def wait(self) -> Request:
        """Wait for the engine's next call."""
        self.latest = self.requests.get(timeout=PATIENCE)
        return self.latest

    def reply(self, state: GameState, **fields: Any) -> None:
        """Answer the call that waits."""
        self._replies.put(Reply(game_state=state, **fields))

    def begin(self, command: GMCommand) -> Request:
        """Begin an episode, and return its first observations."""
        self.reply(GameState.RESET, gm_cmd=command)
        return self.wait()

    def act(self, actions: Mapping[int, Mapping[str, float]] | None = None, times: int = 1) -> Request:
        """Let agents do the same for some actions of 5 frames each, or until the episode is over."""
        commands = [AgentCommand(id=agent, **fields) for agent, fields in (actions or {}).items()]
        for _ in range(times):
            if self.is_over:
                break
            self.reply(GameState.UPDATE, agent_cmd_list=commands)
            self.wait()
        return self.latest

    @property
    def is_over(self) -> bool:
        """Whether the episode is."""
        return self.latest.game_state == GameState.OVER

    def seen_by(self, agent: int = 0) -> Observation:
        """Return an agent's observation."""
        (observation,) = (one for one in self.latest.agent_obs_list if one.id == agent)
        return observation

    def close(self) -> None:
        """Tell the engine to end."""
        self.reply(GameState.CLOSE)

    def die(self) -> None:
        """Be gone from one moment to the next."""
        self._server.stop(0).wait(PATIENCE)  # or an answer might still go out
        self._replies.put(Reply())  # for the thread that waits for what to answer


def begin_at_a_box(competitor: Competitor, asked: GMCommand) -> None:
    """Begin an episode in which agent 0 starts beside boxes of 10."""
    asked.supply_heatmap_center.CopyFrom(asked.agent_setups[0].start_location)
    asked.supply_random_min = asked.supply_random_max = 10
    for seed in range(20):
        asked.random_seed = seed
        competitor.begin(asked)
        if competitor.seen_by(0).can_pickup:
            return
    raise AssertionError("no box near the start with any seed")
