"""A cluster that cannot be used is explained in one line."""

import importlib.util
import socket
from pathlib import Path

import pytest
from tests.evaluator.executors.ray_clusters import ray_cluster
from tests.evaluator.sample_agents import WALKER, Command, Submit

from wildscav.errors import UserError
from wildscav_evaluator.executors import EXECUTORS, ExecutorError
from wildscav_evaluator.executors.base import Examined
from wildscav_evaluator.executors.cluster.connection import check_address
from wildscav_evaluator.executors.ray_executor import _no_sandbox


@pytest.mark.parametrize(
    "address", ["here", "host", "host:", ":6379", "host:port", "host:70000", "http://a:1"]
)
def test_what_is_no_address_is_refused(address: str) -> None:
    with pytest.raises(ExecutorError, match=r"must be HOST:PORT or ray://HOST:PORT") as error:
        check_address(address)
    assert error.value.exit_code == 2


@pytest.mark.parametrize("prefix", ["", "ray://"])
def test_an_address_where_nothing_listens_is_refused_at_once(prefix: str) -> None:
    with socket.create_server(("127.0.0.1", 0)) as server:
        port = server.getsockname()[1]
    with pytest.raises(ExecutorError, match=r"there is no Ray cluster at .*: Connection refused"):
        check_address(f"{prefix}127.0.0.1:{port}")


def test_a_wrong_address_is_one_line_and_leaves_nothing_behind(
    submit: Submit, wildscav: Command, tmp_path: Path
) -> None:
    out = tmp_path / "out"
    refused = wildscav(
        *("evaluate", submit("walker", WALKER).folder, "--executor=ray", "--address=127.0.0.1:1"),
        f"--out={out}",
    )
    assert refused.returncode == 1
    assert refused.stderr == "wildscav: there is no Ray cluster at 127.0.0.1:1: Connection refused\n"
    assert not out.exists()


def test_without_ray_the_command_that_installs_it_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    there = importlib.util.find_spec
    monkeypatch.setattr(
        importlib.util, "find_spec", lambda name, *more: None if name == "ray" else there(name, *more)
    )
    with pytest.raises(UserError, match=r"pip install 'wildscav\[ray\]'"):
        EXECUTORS["ray"]()


def test_an_unknown_executor_is_an_error_of_usage(wildscav: Command) -> None:
    refused = wildscav("verify", ".", "--executor=rey")
    assert refused.returncode == 2
    assert "did you mean 'ray'" in " ".join(refused.stderr.replace("│", "").split())


@pytest.mark.parametrize(
    ("found", "reason"),
    [
        ([], "the Ray cluster has no node with cores"),
        (
            [Examined("east", 2, "it has other code"), Examined("west", 2, "it is old")],
            "no node of the Ray cluster can be used (east: it has other code; west: it is old)",
        ),
        (
            [Examined("east", 2, "", {"oci": "there is no Docker"}), Examined("west", 2, "it is old")],
            (
                "no node of the Ray cluster can run agents in oci (east: oci: there is no Docker; west: it "
                "is old); to run agents that you trust as plain processes, name --sandbox process"
            ),
        ),
    ],
)
def test_why_no_node_can_play(found: list[Examined], reason: str) -> None:
    assert _no_sandbox(found, ["oci"]) == reason


@pytest.mark.slow
def test_a_cluster_of_another_release_of_ray_is_refused_in_one_line(
    wildscav: Command, monkeypatch: pytest.MonkeyPatch
) -> None:
    with ray_cluster(ray_version="2.55.0") as cluster:
        cluster.use(monkeypatch)
        refused = wildscav("doctor", "--executor=ray", f"--address={cluster.address}")

    assert refused.returncode == 1
    assert refused.stderr.startswith(f"wildscav: the Ray cluster at {cluster.address} runs Ray 2.55.0")
    assert len(refused.stderr.splitlines()) == 1
