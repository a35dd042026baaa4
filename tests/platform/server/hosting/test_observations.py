"""What a seat is sent, byte for byte, against protobuf's own classes filled from the engine's arrays."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as some
from numpy.typing import NDArray
from tests.platform.helpers.seats import small_spec

from wildscav.proto.match_pb2 import Observation, SupplyBox, Vector, VisibleAgent
from wildscav_engine.simulation.match import Match
from wildscav_engine.simulation.state import Agents
from wildscav_engine.simulation.systems.visibility import AGENT_LIMIT, SUPPLY_LIMIT
from wildscav_engine.specs.actions import FIELDS
from wildscav_engine.specs.map_spec import MapConfig, MapSpec
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_engine.specs.rules import FRAME
from wildscav_engine.tracks import TRACKS
from wildscav_server.hosting.observation_encoding import BUFFER_SIZE, put_observations
from wildscav_server.hosting.observations import SeatObservations
from wildscav_server.hosting.precompile import precompile

BANK = 29.5  # s, of seat 0; each other one has a second more
AS_THEY_ARE = [
    field.name
    for field in Observation.DESCRIPTOR.fields
    if field.name in Agents._fields and not field.has_presence
]
NEVER_NEGATIVE = ["team", "respawn_left", "reload_left", "invincible_left"]
NEVER_NEGATIVE += [name for name in AS_THEY_ARE if name not in {"yaw", "pitch"}]
# A match with all that can be seen: more agents and boxes than go into one observation.
CROWDED = MatchSpec(
    track="battle",
    map=MapSpec(config=MapConfig(size=60, houses=0, vegetation=0.0), seed=5),
    seed=7,
    seats=("submission",) * 20,
    time_limit=2.0,
)


def vector(place: Any) -> Vector:
    x, y, z = map(float, place)
    return Vector(x=x, y=y, z=z)


def by_protobuf(match: Match, seat: int) -> Observation:
    """Return what a seat observations as protobuf's own classes have it."""
    own = {name: array[0, seat] for name, array in match.state.agents._asdict().items()}
    seen = match.seen
    message = Observation(
        step=match.step_number,
        frame=match.frame,
        time_bank=BANK + seat,
        position=vector(own["position"]),
        velocity=vector(own["velocity"]),
        reloading=bool(own["reload_left"] > 0),
        invincible=bool(own["invincible_left"] > 0),
        respawn_in=float(own["respawn_left"] * FRAME),
        reload_in=float(own["reload_left"] * FRAME),
        invincible_in=float(own["invincible_left"] * FRAME),
        team_supplies=carried_by(match, int(own["team"])),
        can_pick_up=bool(seen.can_pick_up[0, seat]),
        agents=[visible(match, int(one)) for one in seen.agents[0, seat, : seen.agent_count[0, seat]]],
        supply_boxes=[box(match, int(one)) for one in seen.supplies[0, seat, : seen.supply_count[0, seat]]],
    )
    for name in AS_THEY_ARE:
        setattr(message, name, own[name].item())
    for name in ("hit_seat", "hit_by_seat"):
        if own[name] >= 0:
            setattr(message, name, int(own[name]))
    if own["knows_target"]:
        message.target.CopyFrom(vector(match.state.matches.target[0]))
    return message


def carried_by(match: Match, team: int) -> int:
    agents = match.state.agents
    mates = agents.team[0, : match.seats] == team
    return int(agents.supplies[0, : match.seats][mates].sum(dtype=np.int64))


def visible(match: Match, seat: int) -> VisibleAgent:
    agents = match.state.agents
    return VisibleAgent(
        seat=seat,
        team=int(agents.team[0, seat]),
        position=vector(agents.position[0, seat]),
        velocity=vector(agents.velocity[0, seat]),
        yaw=float(agents.yaw[0, seat]),
        health=int(agents.health[0, seat]),
        invincible=bool(agents.invincible_left[0, seat] > 0),
    )


def box(match: Match, slot: int) -> SupplyBox:
    boxes = match.state.supplies
    return SupplyBox(
        id=int(boxes.serial[0, slot]),
        position=vector(boxes.position[0, slot]),
        quantity=int(boxes.quantity[0, slot]),
    )


def sent(match: Match, seats: list[int]) -> list[bytes]:
    observations = SeatObservations(match, seats)
    observations.encode(BANK + seat for seat in seats)
    return [observations.of(seat) for seat in seats]


SEATS = [2, 0, 3, 1]  # in any order
ELSEWHERE = {"tensors"}  # are put behind what the kernel writes


def test_every_field_of_the_protocol_is_written_or_known_to_be_added_later() -> None:
    match = scrambled(seed=1, largest=2**31 - 1, fully=True)
    match.state.agents.hit_seat[:], match.state.agents.hit_by_seat[:] = 1, 1
    match.state.agents.knows_target[:] = True
    (content,) = sent(match, [0])
    message = Observation.FromString(content)

    for kind, written in (
        (Observation, message),
        (VisibleAgent, message.agents[0]),
        (SupplyBox, message.supply_boxes[0]),
    ):
        fields = {field.name for field in kind.DESCRIPTOR.fields}
        assert fields - {field.name for field, _ in written.ListFields()} == (
            ELSEWHERE if kind is Observation else set()
        )


@pytest.mark.parametrize("track", TRACKS)
def test_every_seat_of_every_track_gets_what_protobuf_would_write(track: str) -> None:
    match = Match(small_spec(track, seats=4, filled_by=("submission", "fighter", "submission", "fighter")))
    rng = np.random.default_rng(3)
    while not match.over:
        assert sent(match, SEATS) == [by_protobuf(match, seat).SerializeToString() for seat in SEATS]
        match.step(rng.uniform(0.0, 10.0, (4, FIELDS)).round())


@given(seed=some.integers(0, 2**32 - 1), largest=some.sampled_from([0, 1, 127, 128, 16_383, 2**31 - 1]))
def test_whatever_the_arrays_hold_is_written_as_protobuf_would(seed: int, largest: int) -> None:
    match = scrambled(seed, largest)
    for seat, content in enumerate(sent(match, list(range(match.seats)))):
        assert content == by_protobuf(match, seat).SerializeToString()


def test_a_time_bank_of_whole_seconds_is_as_any_other() -> None:
    match = Match(small_spec())
    observations = SeatObservations(match, [0])
    precompile(())
    observations.encode([30])
    assert Observation.FromString(observations.of(0)).time_bank == 30.0
    kernel: Any = put_observations
    assert len(kernel.outer.signatures) == 1  # nothing more was compiled: agents would wait for it


def test_a_number_that_no_seat_can_be_sent_is_our_mistake_and_never_garbage() -> None:
    match = Match(small_spec())
    match.state.agents.clip[0, 0] = -1
    with pytest.raises(ValueError, match="a number below 0 cannot be sent"):
        sent(match, [0])


def test_the_longest_observation_has_room() -> None:
    match = scrambled(seed=1, largest=2**31 - 1, fully=True)
    lengths = {len(content) for content in sent(match, list(range(match.seats)))}
    assert 2950 < max(lengths) < 3050 < BUFFER_SIZE  # seats above 127 would take 17 bytes more


def scrambled(seed: int, largest: int, *, fully: bool = False) -> Match:
    """Return a match whose arrays hold anything.

    Args:
        seed: Of what they hold.
        largest: Of the whole numbers in them.
        fully: Whether every number is that large, and every list full.
    """
    match, rng = Match(CROWDED), np.random.default_rng(seed)
    seen, agents, boxes = match.seen, match.state.agents, match.state.supplies

    def fill(array: NDArray[Any], least: int, largest: int) -> None:
        if array.dtype.kind == "f":
            array[...] = rng.choice([1e30] if fully else [0.0, -0.0, 7.1, -3e-9], array.shape)
        else:
            array[...] = rng.integers(largest if fully else least, largest, array.shape, endpoint=True)

    for array in agents:
        fill(array, -1, 1 if array.dtype.kind == "b" else largest)
    for name in NEVER_NEGATIVE:
        fill(getattr(agents, name), 0, largest)
    matches = match.state.matches
    for array in (boxes.serial, boxes.quantity, boxes.position, matches.target, matches.step, matches.frame):
        fill(array, 0, largest)
    fill(seen.agents, 0, match.seats - 1)
    fill(seen.agent_count, 0, AGENT_LIMIT)
    fill(seen.supplies, 0, boxes.quantity.shape[1] - 1)
    fill(seen.supply_count, 0, SUPPLY_LIMIT)
    fill(seen.can_pick_up, 0, 1)
    return match
