"""The real sandboxes, where they keep their promises on this machine; containers by each of the engines."""

from collections.abc import Iterator

import pytest
from tests.evaluator.sandbox.available import engine_named, missing

from wildscav_evaluator.sandbox import SANDBOXES, Sandbox
from wildscav_evaluator.sandbox.containers.container_engine import ENGINES

REAL = ["bubblewrap", *(pytest.param(f"oci-{name}", marks=pytest.mark.slow) for name in ENGINES)]


def sandbox_named(request: pytest.FixtureRequest) -> Iterator[Sandbox]:
    name, _, engine = request.param.partition("-")
    with engine_named(engine, request):
        if why := missing(name):
            pytest.skip(f"{request.param}: {why}")
        yield SANDBOXES[name]


@pytest.fixture(scope="module", params=REAL)
def real(request: pytest.FixtureRequest) -> Iterator[Sandbox]:
    """Each sandbox that isolates; skipped where it cannot be had."""
    yield from sandbox_named(request)


@pytest.fixture(scope="module", params=["process", *REAL])
def sandbox(request: pytest.FixtureRequest) -> Iterator[Sandbox]:
    """Each sandbox; skipped where it cannot be had."""
    yield from sandbox_named(request)
