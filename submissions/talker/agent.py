"""Lets a language model play: the one that the organizer of a match offers by a gateway."""

import os
from pathlib import Path

from wildscav.errors import UserError
from wildscav.harness.player import ModelPlayer
from wildscav.harness.settings import read_settings
from wildscav.words import WordsPlayer, WordsSeat

SETTINGS = Path(__file__).with_name("settings.toml")


class Talker(WordsPlayer):
    """Asks the model what to do, until the match is over."""

    def play(self, seat: WordsSeat) -> None:
        """Play a match."""
        if "WILDSCAV_MODEL" not in os.environ:
            raise UserError("there is no model to ask: name one with --model FILE")
        ModelPlayer(seat, read_settings(SETTINGS)).play()
