"""The front desk of a shared server: it opens matches at the workers and asks them how they stand."""

from collections.abc import Awaitable, Callable, Sequence
from itertools import count
from typing import TypeVar

import grpc

from wildscav.proto.match_pb2 import GetMatchRequest, GetMatchResponse, HostMatchRequest, HostMatchResponse
from wildscav.proto.match_pb2_grpc import ArenaServicer
from wildscav.server.addresses import UNIX
from wildscav.server.organizer import Context, Organizer
from wildscav.server.workforce import Worker, WorkerLostError
from wildscav.wire.errors import RefusalError, encode_refusal, reason_of

Answer = TypeVar("Answer")
State = GetMatchResponse.State


class FrontDesk(ArenaServicer):
    """Serves organizers at one address.

    A match's id is ``WORKER.GENERATION-ID``: it says who plays it, and whether that process is there yet.

    Args:
        workers: Take turns.
        place: Which one of a worker's addresses goes with this one.
        organizer: Tells who may call.
    """

    def __init__(self, workers: Sequence[Worker], place: int, organizer: Organizer) -> None:
        self._workers, self._place, self._organizer = workers, place, organizer
        self._turns = count()

    async def HostMatch(self, request: HostMatchRequest, context: Context) -> HostMatchResponse:  # noqa: N802
        """Open a match at the worker whose turn it is, or at the next one that has room."""
        return await self._answer(context, lambda: self._host(request))

    async def GetMatch(self, request: GetMatchRequest, context: Context) -> GetMatchResponse:  # noqa: N802
        """Tell how a match stands."""
        return await self._answer(context, lambda: self._get(request.match_id))

    async def _answer(self, context: Context, call: Callable[[], Awaitable[Answer]]) -> Answer:
        """Answer a call; what a worker refuses is refused in its words."""
        try:
            self._organizer.check(context)
            return await call()
        except RefusalError as error:
            refusal = error
        except grpc.aio.AioRpcError as error:
            refusal = RefusalError(error.code(), reason_of(error), error.details() or "the worker refused")
        await context.abort_with_status(encode_refusal(refusal))
        raise refusal

    async def _host(self, request: HostMatchRequest) -> HostMatchResponse:
        full: Exception | None = None
        for _ in self._workers:
            worker = self._workers[next(self._turns) % len(self._workers)]
            try:
                hosted: HostMatchResponse = await worker.arena.HostMatch(request)
            except (WorkerLostError, grpc.aio.AioRpcError) as error:
                if not _is_elsewhere_possible(error):
                    raise
                full = error
                continue
            hosted.match_id = f"{worker.number}.{worker.generation}-{hosted.match_id}"
            hosted.seat_address = as_told(worker.seats[self._place])
            return hosted
        raise RefusalError(
            grpc.StatusCode.RESOURCE_EXHAUSTED,
            "ARENA_FULL",
            f"no worker takes a match; try later ({full})",
        )

    async def _get(self, match_id: str) -> GetMatchResponse:
        unknown = RefusalError(
            grpc.StatusCode.NOT_FOUND, "MATCH_UNKNOWN", f"there is no match {match_id!r}, or no more"
        )
        who, _, own = match_id.partition("-")
        number, _, generation = who.partition(".")
        workers = {str(worker.number): worker for worker in self._workers}
        worker = workers.get(number)
        if worker is None or not generation.isdecimal() or int(generation) > worker.generation:
            raise unknown
        try:
            if int(generation) == worker.generation:
                answer: GetMatchResponse = await worker.arena.GetMatch(GetMatchRequest(match_id=own))
                return answer
        except WorkerLostError:
            pass
        except grpc.aio.AioRpcError as error:
            if error.code() != grpc.StatusCode.UNAVAILABLE:
                raise
        return GetMatchResponse(
            state=State.STATE_FAILED, error=f"the platform failed: worker {number} ended in the middle of it"
        )


def _is_elsewhere_possible(error: Exception) -> bool:
    """Return whether another worker might take a match that one did not."""
    if isinstance(error, grpc.aio.AioRpcError):
        return error.code() == grpc.StatusCode.UNAVAILABLE or reason_of(error) == "ARENA_FULL"
    return True


def as_told(address: str) -> str:
    """Return an address as organizers are told it: they know the host better than the server."""
    return address if address.startswith(UNIX) else f":{address.rpartition(':')[2]}"
