"""Engines and clients that play together."""

import threading
from collections.abc import Iterator
from pathlib import Path

import pytest
from tests.platform.legacy.competitor import Competitor

from wildscav.legacy.channel import Client
from wildscav.legacy.session import Session


@pytest.fixture
def competitor(tmp_path: Path) -> Iterator[Competitor]:
    """A client whose engine runs in this process, and writes its records into ``tmp_path``."""
    competitor = Competitor()
    client = Client(f"127.0.0.1:{competitor.port}")
    engine = threading.Thread(target=Session(client, tmp_path).run)
    engine.start()
    competitor.wait()
    yield competitor
    competitor.close()
    engine.join(timeout=10)
    client.close()
    competitor.die()
    assert not engine.is_alive(), "close ends the engine"
