"""The dispatcher of a shared server: it forwards organizers' calls to the workers."""

from collections.abc import Awaitable, Sequence
from itertools import count
from typing import TypeVar

import grpc

from wildscav.proto.match_pb2 import GetMatchRequest, GetMatchResponse, HostMatchRequest, HostMatchResponse
from wildscav.wire.errors import RefusalError, reason_of
from wildscav.wire.matches import encode_seat_address
from wildscav_server.workers.supervisor import WorkerLostError, WorkerSupervisor

HOST_TIMEOUT = 300.0  # s that a worker has to open a match; its map may take half a minute, and others wait
GET_TIMEOUT = 30.0  # s that it has to return the state of one
Answer = TypeVar("Answer")
State = GetMatchResponse.State


class Dispatcher:
    """Implements the Arena service at one address of a shared server by forwarding calls to its workers.

    A match's id is ``WORKER.GENERATION-ID``: it identifies the worker, and the process of that worker.

    Args:
        place: Index of the address among those of the server, and of its seats' address among a worker's.
    """

    def __init__(self, workers: Sequence[WorkerSupervisor], place: int) -> None:
        self._workers, self._place = workers, place
        self._turns = count()

    async def host_match(self, request: HostMatchRequest) -> HostMatchResponse:
        """Open a match at the next worker in turn that has room."""
        return await _forward_refusal(self._host(request))

    async def get_match(self, request: GetMatchRequest) -> GetMatchResponse:
        """Return the state of a match. See ``routes.ArenaHandler``."""
        return await _forward_refusal(self._get(request.match_id))

    async def _host(self, request: HostMatchRequest) -> HostMatchResponse:
        full: Exception | None = None
        for _ in self._workers:
            worker = self._workers[next(self._turns) % len(self._workers)]
            try:
                hosted: HostMatchResponse = await worker.arena.HostMatch(request, timeout=HOST_TIMEOUT)
            except (WorkerLostError, grpc.aio.AioRpcError) as error:
                if not _may_succeed_elsewhere(error):
                    raise
                full = error
                continue
            hosted.match_id = f"{worker.number}.{worker.generation}-{hosted.match_id}"
            hosted.seat_address = encode_seat_address(worker.seats[self._place])
            return hosted
        raise RefusalError(
            grpc.StatusCode.RESOURCE_EXHAUSTED,
            "ARENA_FULL",
            f"no worker takes a match; try later ({full})",
        )

    async def _get(self, match_id: str) -> GetMatchResponse:
        unknown = RefusalError(
            grpc.StatusCode.NOT_FOUND, "MATCH_UNKNOWN", f"there is no match {match_id!r}, or no longer"
        )
        process, _, own = match_id.partition("-")
        number, _, generation = process.partition(".")
        workers = {str(worker.number): worker for worker in self._workers}
        worker = workers.get(number)
        if worker is None or not generation.isdecimal() or int(generation) > worker.generation:
            raise unknown
        try:
            if int(generation) == worker.generation:
                ask = GetMatchRequest(match_id=own)
                answer: GetMatchResponse = await worker.arena.GetMatch(ask, timeout=GET_TIMEOUT)
                return answer
        except WorkerLostError:
            pass
        except grpc.aio.AioRpcError as error:
            if error.code() != grpc.StatusCode.UNAVAILABLE:
                raise
        return GetMatchResponse(
            state=State.STATE_FAILED, error=f"the platform failed: worker {number} ended during the match"
        )


async def _forward_refusal(call: Awaitable[Answer]) -> Answer:
    """Wait for a worker's answer, and forward a refusal."""
    try:
        return await call
    except grpc.aio.AioRpcError as error:
        raise RefusalError(error.code(), reason_of(error), error.details() or "the worker refused") from error


def _may_succeed_elsewhere(error: Exception) -> bool:
    """Return whether another worker may accept a match that one did not."""
    if isinstance(error, grpc.aio.AioRpcError):
        lost = (grpc.StatusCode.UNAVAILABLE, grpc.StatusCode.DEADLINE_EXCEEDED)
        return error.code() in lost or reason_of(error) == "ARENA_FULL"
    return True
