"""The API does what its OpenAPI description says, whatever it is asked: schemathesis asks."""

from collections.abc import Callable, Iterator
from typing import Any

import pytest
from hypothesis import HealthCheck, Phase, given, settings
from tests.leaderboard.filled_season import HOSTILE, FilledSeason
from tests.leaderboard.hosting.clients import Site, serving_filled

schemathesis = pytest.importorskip("schemathesis", reason="needs schemathesis: pip install schemathesis")
checks = pytest.importorskip("schemathesis.specs.openapi.checks")
pytestmark = pytest.mark.slow
EXAMPLES = 8  # of each operation
CHECKS = [
    pytest.importorskip("schemathesis.checks").not_a_server_error,
    checks.response_schema_conformance,
    checks.content_type_conformance,
    checks.status_code_conformance,
]


@pytest.fixture(scope="module")
def site(new_filled_season: Callable[..., FilledSeason]) -> Iterator[Site]:
    with serving_filled(new_filled_season(words=HOSTILE)) as site:
        yield site


@pytest.fixture(scope="module")
def cases(site: Site) -> list[tuple[Any, dict[str, str]]]:
    """Valid requests of every operation and others, each with its headers but the token."""
    schema = schemathesis.openapi.from_url(f"{site.client.base_url}/api/v1/openapi.json", timeout=60)
    drawn: list[tuple[Any, dict[str, str]]] = []
    for found in schema.get_all_operations():
        operation = found.ok()
        if "/tokens/current" in operation.path:
            continue  # whoever asks would be nobody afterwards

        @settings(
            max_examples=EXAMPLES,
            derandomize=True,
            database=None,
            deadline=None,
            phases=[Phase.explicit, Phase.generate],
            suppress_health_check=list(HealthCheck),
        )
        @given(case=operation.as_strategy())
        def draw(case: Any) -> None:
            drawn.append((case, without_token(case.headers)))

        draw()
    return drawn


def without_token(headers: Any) -> dict[str, str]:
    return {name: value for name, value in (headers or {}).items() if name.lower() != "authorization"}


@pytest.mark.parametrize("asker", ["visitor", "other", "owner", "organizer"])
def test_answers_are_as_described_whatever_is_asked(
    site: Site, cases: list[tuple[Any, dict[str, str]]], asker: str
) -> None:
    person = site.filled.people.get(asker)
    token = {} if person is None else {"Authorization": f"Bearer {person.token}"}
    wrong: list[str] = []
    for case, headers in cases:
        case.headers = {**headers, **token}
        response = case.call()
        try:
            case.validate_response(response, checks=CHECKS)
        except (AssertionError, schemathesis.errors.SchemathesisError, BaseExceptionGroup) as error:
            wrong.append(f"{case.method} {case.formatted_path} as {asker}: {response.status_code} {error}")
    assert not wrong, "\n".join(wrong)
