"""Which sandboxes and container engines a test can have on this machine."""

import contextlib
import functools
import os
import sys
from collections.abc import Iterator

import pytest
from tests.evaluator.sandbox.sandbox_runs import LIMITS

from wildscav_evaluator.sandbox import SANDBOXES
from wildscav_evaluator.sandbox.containers.container_engine import CHOICE


@contextlib.contextmanager
def engine_named(engine: str, request: pytest.FixtureRequest) -> Iterator[None]:
    """Run containers by an engine, Docker with a daemon; skipped where none can be had."""
    with pytest.MonkeyPatch.context() as environment:
        if engine:
            environment.setenv(CHOICE, engine)
        if engine == "docker":
            environment.setenv("DOCKER_HOST", request.getfixturevalue("docker"))
        yield


def missing(name: str) -> str:
    """Return what a sandbox lacks on this machine, nothing if it is whole."""
    return _missing(name, os.environ.get(CHOICE, ""))


@functools.cache
def _missing(name: str, engine: str) -> str:
    del engine  # another one, another answer
    if sys.platform != "linux":
        return "it is Linux's"
    broken = [promise for promise in SANDBOXES[name].promises(LIMITS) if not promise.kept]
    return "; ".join(f"{promise.name}: {promise.found} {promise.remedy}" for promise in broken)
