"""gRPC reads how it is set when it is imported, so it must have been set before."""

import os
import subprocess
import sys

import pytest

from wildscav.grpc_settings import EXPERIMENTS, VARIABLE

WATCHED = """
import os, sys

class Watch:
    def find_spec(self, name, path=None, target=None):
        if name == "grpc":
            print("set to", os.environ.get("{variable}"))

sys.meta_path.insert(0, Watch())
import {module}
"""


def what_grpc_reads(module: str, environment: dict[str, str]) -> str:
    """Return what stands in the environment when gRPC is imported for a module of ours."""
    inherited = {name: value for name, value in os.environ.items() if name != VARIABLE}
    code = WATCHED.format(variable=VARIABLE, module=module)
    done = subprocess.run(
        [sys.executable, "-c", code],
        env=inherited | environment,
        capture_output=True,
        text=True,
        check=True,
    )
    return done.stdout.splitlines()[0]


@pytest.mark.parametrize(
    "module",
    ["wildscav.sdk.connection", "wildscav_server.match_server", "wildscav_legacy.channel, grpc"],
)
def test_whatever_imports_grpc_has_set_it_before(module: str) -> None:
    assert what_grpc_reads(module, {}) == f"set to {EXPERIMENTS}"


def test_what_the_environment_says_is_kept() -> None:
    assert what_grpc_reads("wildscav.sdk.connection", {VARIABLE: ""}) == "set to "
