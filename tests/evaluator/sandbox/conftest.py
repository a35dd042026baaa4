"""The real sandboxes, where they keep their promises on this machine."""

import functools
import sys

import pytest
from tests.evaluator.sandbox.world import LIMITS

from wildscav_evaluator.sandbox import SANDBOXES, Sandbox

REAL = [
    pytest.param(name, marks=pytest.mark.slow) if name == "oci" else name
    for name, sandbox in SANDBOXES.items()
    if sandbox.isolated
]


@pytest.fixture(scope="module", params=REAL)
def real(request: pytest.FixtureRequest) -> Sandbox:
    """Each sandbox that isolates; skipped where it cannot be had."""
    why = missing(request.param)
    if why:
        pytest.skip(f"{request.param}: {why}")
    return SANDBOXES[request.param]


@functools.cache
def missing(name: str) -> str:
    """Return what a sandbox lacks on this machine, nothing if it is whole."""
    if sys.platform != "linux":
        return "it is Linux's"
    broken = [promise for promise in SANDBOXES[name].promises(LIMITS) if not promise.kept]
    return "; ".join(f"{promise.name}: {promise.found} {promise.remedy}" for promise in broken)
