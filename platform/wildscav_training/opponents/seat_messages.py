"""What a seat of a match in a batch is told: the same as over gRPC, and by the same code."""

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from wildscav.agent import MatchInfo, Observation
from wildscav.proto.match_pb2 import ServerMessage
from wildscav.wire.matches import decode_match_info, encode_match_info
from wildscav.wire.observations import decode_observation, encode_observation
from wildscav_engine.compilation.kernel import kernel
from wildscav_engine.compilation.tables.array_tables import Addresses
from wildscav_engine.envs.spaces.match_in_batch import MatchInBatch
from wildscav_engine.simulation.batch_kernels import agents_of, seen_of, supplies_of
from wildscav_engine.simulation.match import start_info
from wildscav_engine.simulation.state import matches_at
from wildscav_engine.specs.rules import FRAMES_PER_SECOND
from wildscav_server.hosting.observation_encoding import BUFFER_SIZE, put_observation
from wildscav_server.hosting.observations import info_from
from wildscav_server.time_limits import Clock

if TYPE_CHECKING:
    from wildscav_engine.sensors import Sensor
    from wildscav_engine.simulation.batch import Batch

Indices = NDArray[np.int64]


def seat_info(batch: "Batch", match: int, seat: int, clock: Clock) -> MatchInfo:
    """Return what an agent learns before the first step of a match."""
    spec = batch.specs[match]
    info = info_from(spec, start_info(batch, match, seat), seat, clock.fitted(spec))
    return decode_match_info(encode_match_info(info).match_info)


def seat_observations(
    batch: "Batch", matches: Indices, seats: Indices, time_banks: NDArray[np.float64]
) -> list[bytes]:
    """Return the encoded observations of some seats, without tensors.

    Args:
        matches: (N,) the index of each seat's match.
        seats: (N,) the number of each seat in its match.
        time_banks: (N,) s, what is left of the seats' time banks.
    """
    out = np.empty((len(seats), BUFFER_SIZE), np.uint8)
    lengths = np.zeros(len(seats), np.int64)
    _put_seats(*batch.tables, matches, seats, time_banks, out, lengths)
    return [row[:length].tobytes() for row, length in zip(out, lengths.tolist(), strict=True)]


def decode_for_agent(
    encoded: bytes, sensors: "dict[str, Sensor]", batch: "Batch", match: int, seat: int
) -> Observation:
    """Return an observation as the SDK shows it, with the readings of the seat's sensors."""
    view = MatchInBatch(batch, match) if sensors else None
    tensors = {} if view is None else {name: one.read(view, [seat])[0] for name, one in sensors.items()}
    message = ServerMessage.FromString(encode_observation(encoded, tensors))
    return decode_observation(message.observation, FRAMES_PER_SECOND)


@kernel
def _put_seats(
    agents: Addresses,
    supplies: Addresses,
    every: Addresses,
    seen: Addresses,
    chosen: Indices,
    seats: Indices,
    time_banks: NDArray[np.float64],
    out: NDArray[np.uint8],
    lengths: Indices,
) -> None:
    """Write the observations of ``seats`` (N,), each in its ``chosen`` match; see ``put_observations``."""
    matches = matches_at(every)
    for index in range(seats.shape[0]):
        match = chosen[index]
        count = matches.seats[match]
        lengths[index] = put_observation(
            out[index],
            agents_of(agents, match, count),
            supplies_of(supplies, match, matches.slots[match]),
            matches,
            seen_of(seen, match, count),
            match,
            seats[index],
            time_banks[index],
        )
