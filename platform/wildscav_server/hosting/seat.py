"""One submission seat of a hosted match: its token, its stream, its time and its conduct."""

import asyncio
from array import array
from collections.abc import Callable, Mapping
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

import grpc
from numpy.typing import NDArray

from wildscav.errors import SensorError
from wildscav.proto.match_pb2 import SeatConduct
from wildscav.wire.errors import RefusalError
from wildscav_server.hosting.reports import Conduct, SeatReport, SeatStatus, ThinkTime
from wildscav_server.thinking import Purse
from wildscav_server.time_limits import TimeBank, WaitMeter

if TYPE_CHECKING:
    from wildscav_engine.sensors import Sensor
    from wildscav_engine.simulation.match import Match


class Seat:
    """A seat that an agent process fills."""

    def __init__(self, number: int, token: str, bank: TimeBank, sensors: dict[str, "Sensor"]) -> None:
        self.number = number
        self.token = token
        self.bank = bank
        self.sensors = sensors
        self.stream: asyncio.Task[Any] | None = None  # the task that serves its stream
        self.refusal: RefusalError | None = None  # why its stream was ended
        self.sdk = ""  # its client's name and version
        self.gets_ready = False  # whether its client will send a Ready
        self.ready = False  # whether its agent is set up
        self.start_up: float | None = None  # s from its start until it was ready
        self.gone = False  # whether it is played with no action for the rest of the match
        self.asked = -1  # step of the last observation that was sent to it
        self.asked_at = 0.0  # when its time for that step began: the time of sending minus ``sensor_time``
        self.sensor_time = 0.0  # s that reading its sensors took for that step
        self.conduct = Conduct()
        self.first_late: int | None = None  # the first step that was played without its answer
        self.meter: WaitMeter | None = None  # of its agent's waits for a processor, if its host has one
        self.purse = Purse()  # what its thinking has cost
        self.held_steps = 0  # that were played with its last action, because it thought
        self.times = array("d")  # s, for each step
        self.notified = False  # whether its stream is about to fetch an observation
        self.wakes: Callable[[], None] | None = None  # called when it is notified; None: it owes an answer

    @property
    def present(self) -> bool:
        """Whether it has joined and is not gone."""
        return self.stream is not None and not self.gone

    def notify(self) -> None:
        """Wake its stream because there is a message for it; does nothing if it owes an answer."""
        if self.wakes is not None:
            self.notified = True
            asyncio.get_running_loop().call_soon(self.wakes)
            self.wakes = None

    def dismiss(self, refusal: RefusalError) -> None:
        """End the seat's stream, if it has one, with a refusal."""
        if self.stream is not None and self.refusal is None:
            self.refusal = refusal
            self.stream.cancel()

    def close(self, status: SeatStatus, reason: str) -> None:
        """Play it with no action from now on, and end its stream."""
        self.gone = True
        self.set_outcome(status, reason)
        self.dismiss(RefusalError(grpc.StatusCode.FAILED_PRECONDITION, "SEAT_CLOSED", reason))

    def read_sensors(self, match: "Match") -> dict[str, NDArray[Any]]:
        """Read the seat's sensors."""
        return {name: sensor.read(match, [self.number])[0] for name, sensor in self.sensors.items()}

    def begin_waiting(self) -> None:
        """Measure its agent's waits for a processor from now on."""
        if self.meter is not None:
            self.meter.start()

    def waited(self) -> float:
        """Return how long its agent has waited for a processor, s; 0 if nobody measures it."""
        return 0.0 if self.meter is None else self.meter.waited()

    def set_outcome(self, status: SeatStatus, detail: str) -> None:
        """Set how the seat's part in the match ended, and why."""
        self.conduct.status = status
        self.conduct.detail = detail

    def conduct_message(self) -> SeatConduct:
        """Return its conduct so far as a protocol message."""
        time = ThinkTime.of(self.times)
        return SeatConduct(
            fault=self.conduct.status.fault or "",
            time_used=time.total,
            latency_p50=time.p50,
            latency_p99=time.p99,
            latency_max=time.max,
            time_bank=self.bank.left,
            **asdict(self.conduct),
        )

    def report(self) -> SeatReport:
        """Return a report of its conduct so far."""
        return SeatReport(
            seat=self.number,
            think_time=ThinkTime.of(self.times),
            time_bank=self.bank.left,
            start_up=self.start_up,
            credited=None if self.meter is None else self.bank.credited,
            tokens=self.purse.tokens,
            processor=self.purse.processor / 1e9,
            held_steps=self.held_steps,
            **asdict(self.conduct),
        )


def parse_sensors(wanted: Mapping[str, Mapping[str, Any]]) -> dict[str, "Sensor"]:
    """Return the sensors that a seat asks for; a SensorError if there is no such sensor or option."""
    from wildscav_engine.sensors import parse_sensors

    try:
        return parse_sensors(wanted)
    except ValueError as error:
        raise SensorError(str(error)) from None
