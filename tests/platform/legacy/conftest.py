"""Engines and clients that play together."""

import threading
from collections.abc import Iterator

import pytest
from tests.platform.legacy.helpers.competitor import Competitor

from wildscav_legacy.channel import Client
from wildscav_legacy.session import Session
from wildscav_server.hosting.precompile import precompile


@pytest.fixture(scope="session", autouse=True)
def compiled() -> None:
    """Compile what plays matches, so that no client waits for that."""
    precompile([])


@pytest.fixture(scope="module")
def competitor(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Competitor]:
    """A client whose engine runs in this process: one session for all episodes of a file of tests."""
    competitor = Competitor()
    client = Client(f"127.0.0.1:{competitor.port}")
    competitor.records = tmp_path_factory.mktemp("records")
    engine = threading.Thread(target=Session(client, competitor.records).run)
    engine.start()
    competitor.wait()
    yield competitor
    competitor.close()
    engine.join(timeout=120)
    client.close()
    competitor.die()
    assert not engine.is_alive(), "close ends the engine"
