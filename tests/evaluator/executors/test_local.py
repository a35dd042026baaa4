"""The executor of this machine calls functions in order, and knows no addresses."""

import itertools
from collections.abc import Iterator

import pytest

from wildscav.errors import UserError
from wildscav_evaluator.executors.local import QUEUED, LocalExecutor


@pytest.mark.parametrize("at_once", [1, 2])
def test_values_come_in_the_order_of_the_items(at_once: int) -> None:
    with LocalExecutor(at_once) as executor:
        assert list(executor.map(hex, range(40))) == [hex(number) for number in range(40)]


def test_items_are_taken_only_as_they_are_needed() -> None:
    taken: list[int] = []

    def items() -> Iterator[int]:
        for number in itertools.count():
            taken.append(number)
            yield number

    with LocalExecutor(2) as executor:
        values = executor.map(hex, items())  # they never end
        assert list(itertools.islice(values, 5)) == ["0x0", "0x1", "0x2", "0x3", "0x4"]
        values.close()  # type: ignore[attr-defined]
    assert len(taken) <= 5 + 2 * QUEUED


def test_an_address_needs_a_cluster() -> None:
    with pytest.raises(UserError, match="--executor local has none"):
        LocalExecutor(address="127.0.0.1:6379")
