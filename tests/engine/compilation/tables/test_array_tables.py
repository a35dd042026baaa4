"""Tables of arrays: kernels find the very arrays that a table tells of."""

import copy
from typing import NamedTuple

import numpy as np
import pytest
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import kernel
from wildscav_engine.compilation.passed_tables import pass_as_table
from wildscav_engine.compilation.tables.array_tables import (
    Addresses,
    ArrayTable,
    addresses_of,
    number_reader,
    reader,
    row_reader,
    values_reader,
)


class Things(NamedTuple):
    flag: NDArray[np.bool_]  # (B, A)
    place: NDArray[np.float64]  # (B, A, 3)
    count: NDArray[np.int32]  # (B, A)


class Numbers(NamedTuple):
    speed: float = 0.5
    rounds: int = 15


def things(b: int = 3, a: int = 4) -> Things:
    return Things(
        np.zeros((b, a), np.bool_),
        np.arange(b * a * 3, dtype=np.float64).reshape(b, a, 3),
        np.zeros((b, a), np.int32),
    )


things_at = reader(things())
row_at = row_reader(things())
numbers_from = number_reader(Numbers())


@kernel
def _mark_last(table: Addresses) -> None:
    all_of = things_at(table)
    all_of.flag[-1, -1] = True
    all_of.count[-1, -1] = all_of.place.shape[0] * 100 + all_of.place.shape[1] * 10 + all_of.place.shape[2]


@kernel
def _mark_row(table: Addresses, row: int, count: int) -> None:
    one = row_at(table, row, count)
    for index in range(one.flag.shape[0]):
        one.flag[index] = True
        one.count[index] = np.int32(one.place[index, 2])
    one.place[0] = -1.0


@kernel
def _add(values: NDArray[np.float64], answer: NDArray[np.float64]) -> None:
    numbers = numbers_from(values)
    answer[0] = numbers.rounds // 2 + numbers.speed


def test_a_kernel_writes_into_the_arrays_of_a_table() -> None:
    arrays = things()
    _mark_last(ArrayTable(arrays).addresses)
    assert arrays.flag.sum() == 1
    assert arrays.flag[2, 3]
    assert arrays.count[2, 3] == 343


def test_a_row_is_read_without_its_padding() -> None:
    arrays = things()
    _mark_row(addresses_of(arrays), 1, 2)
    assert arrays.flag.tolist() == [[False] * 4, [True, True, False, False], [False] * 4]
    assert arrays.count[1].tolist() == [14, 17, 0, 0]
    assert (arrays.place == -1.0).sum() == 3
    assert arrays.place[1, 0].tolist() == [-1.0, -1.0, -1.0]


def test_numbers_keep_their_kinds() -> None:
    answer = np.zeros(1)
    _add(np.array([0.25, 15.0]), answer)
    assert answer[0] == 7.25


def test_a_copy_of_a_table_is_of_a_copy_of_its_arrays() -> None:
    table = ArrayTable(things())
    other = copy.deepcopy(table)
    _mark_row(other.addresses, 0, 1)
    assert other.arrays.flag[0, 0]
    assert not table.arrays.flag.any()


def test_arrays_that_are_not_contiguous_are_refused() -> None:
    arrays = things()
    with pytest.raises(ValueError, match="place is not contiguous"):
        addresses_of(arrays._replace(place=arrays.place[:, ::2]))


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ({"count": np.zeros((3, 4))}, r"Things\.count is float64 with 2 axes, must be int32 with 2"),
        ({"flag": np.zeros(3, np.bool_)}, r"Things\.flag is bool with 1 axes, must be bool with 2"),
    ],
)
def test_arrays_that_kernels_would_misread_are_refused(wrong: dict[str, np.ndarray], said: str) -> None:
    with pytest.raises(TypeError, match=said):
        ArrayTable(things()._replace(**wrong))


@pass_as_table
class Passed(NamedTuple):
    flag: NDArray[np.bool_]  # (B, A)
    place: NDArray[np.float64]  # (B, A, 3)
    count: NDArray[np.int32]  # (B, A)


def passed(b: int = 3, a: int = 4) -> Passed:
    return Passed(*things(b, a))


passed_at = reader(passed())
passed_row_at = row_reader(passed())
passed_values = values_reader(passed(), ("place", ("flag",)))


@kernel
def _mark(all_of: Passed, last: int) -> None:
    all_of.flag[-1, -1] = True
    all_of.count[-1, -1] = all_of.place.shape[0] * 100 + all_of.place.shape[1] * 10 + last


@kernel
def _mark_passed(table: Addresses) -> None:
    _mark(passed_at(table), 3)


@kernel
def _mark_nested(both: tuple[int, Passed]) -> None:
    _mark(both[1], both[0])


@pytest.mark.parametrize("way", ["table", "Python", "nested"])
def test_a_class_passed_as_a_table_is_the_same_for_kernels_however_it_comes(way: str) -> None:
    arrays = passed()
    if way == "table":
        _mark_passed(addresses_of(arrays))
    elif way == "Python":
        _mark(arrays, 3)
    else:
        _mark_nested((3, arrays))
    assert arrays.count.tolist() == [[0] * 4, [0] * 4, [0, 0, 0, 343]]
    assert arrays.flag.sum() == arrays.flag[2, 3] == 1


@kernel
def _sum_row(row: Passed) -> float:
    total = 0.0
    for index in range(row.flag.shape[0]):
        row.count[index] += 1
        total += row.place[index, 1]
    return total


@kernel
def _sum_rows(table: Addresses, sums: NDArray[np.float64]) -> None:
    for row in range(sums.shape[0]):
        values = passed_values(passed_at(table), row * table[0, 3])
        sums[row] = _sum_row(passed_row_at(table, row, 2)) + 1000.0 * values[0] + 100.0 * values[3]


def test_rows_of_such_a_class_are_tables_of_their_own() -> None:
    arrays, sums = passed(), np.zeros(3)
    arrays.flag[1, 0] = True
    _sum_rows(addresses_of(arrays), sums)
    assert arrays.count.tolist() == [[1, 1, 0, 0]] * 3
    assert sums.tolist() == [1.0 + 4.0, 13.0 + 16.0 + 12000.0 + 100.0, 25.0 + 28.0 + 24000.0]


@kernel
def _first(arrays: Passed) -> float:
    return arrays.place[0, 0, 0]


def test_arrays_with_gaps_are_passed_one_by_one() -> None:
    every_other = Passed(*(array[:, ::2] for array in passed()))
    assert _first(every_other) == 0.0
