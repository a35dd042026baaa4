"""Whole matches of a real server, in which a scripted model plays a seat."""

import asyncio
from pathlib import Path
from typing import Any, NamedTuple

from tests.platform.helpers.seats import host, serving
from tests.scripted_model import Script, ScriptedModel

from wildscav.harness.player import Course, ModelPlayer
from wildscav.harness.settings import ModelSettings
from wildscav_engine.record import write_record
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_engine.specs.result import MatchResult
from wildscav_language.rules_text import rules
from wildscav_language.seat import Seat
from wildscav_language.senses import sensors
from wildscav_server.match_server import MatchServer


class ModelMatch(NamedTuple):
    """How a match of a model went."""

    course: Course
    result: MatchResult
    record: Path


def model_match(spec: MatchSpec, script: Script, folder: Path, **settings: Any) -> ModelMatch:
    """Play a match, and write its record.

    Args:
        spec: Of the match; the other seats are robots'.
        script: What the model answers.
        folder: For the record, and for the match's socket.
        settings: Of the model, besides its address.
    """

    def ask(seat: Seat) -> Course:
        with ScriptedModel(script) as model:
            return ModelPlayer(seat, ModelSettings(url=model.url, **settings), rules(seat.match)).play()

    async def play(server: MatchServer, address: str) -> ModelMatch:
        own = spec.seats.index("submission")
        hosted = await host(server, spec, sensors={own: sensors()})
        seat = Seat(hosted.names)
        playing = asyncio.create_task(asyncio.to_thread(seat.play, address, hosted.tokens[own]))
        course = await asyncio.to_thread(ask, seat)
        await playing
        match = (await hosted.finished()).match
        write_record(folder / "match.wsr", match, hosted.names)
        return ModelMatch(course, match.result(), folder / "match.wsr")

    return serving(folder, play)
