"""The cluster that tests share."""

from collections.abc import Iterator

import pytest
from tests.evaluator.executors.ray_clusters import RayCluster, ray_cluster


@pytest.fixture(scope="session")
def two_nodes() -> Iterator[RayCluster]:
    """A cluster of two nodes with two cores each, which no test changes."""
    with ray_cluster("east", "west", cores=2) as cluster:
        yield cluster


@pytest.fixture
def in_cluster(two_nodes: RayCluster, monkeypatch: pytest.MonkeyPatch) -> RayCluster:
    """The shared cluster, which this process may use."""
    for name, value in two_nodes.environment.items():
        if name.startswith("RAY_"):
            monkeypatch.setenv(name, value)
    return two_nodes
