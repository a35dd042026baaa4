"""One server for the tests of each file."""

from collections.abc import Iterator

import pytest
from tests.leaderboard.competing.season_site import Site, competitor, season_site

__all__ = ["competitor"]


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Site]:
    """A season that is served."""
    with season_site(tmp_path_factory.mktemp("site")) as one:
        yield one
