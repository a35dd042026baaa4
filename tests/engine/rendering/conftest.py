"""Maps shared by the tests of images."""

import pytest
from tests.engine.rendering.views import COUNTRIES, Country

from wildscav_engine.maps import generate_map


@pytest.fixture(scope="session", params=COUNTRIES)
def country(request: pytest.FixtureRequest) -> Country:
    return Country(generate_map(*COUNTRIES[request.param]))


@pytest.fixture(scope="session")
def village() -> Country:
    return Country(generate_map(*COUNTRIES["houses and trees"]))


@pytest.fixture(scope="session")
def lake() -> Country:
    return Country(generate_map(*COUNTRIES["lakes"]))
