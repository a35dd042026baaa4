"""Kernels that only kernels call are parts: linked into those that Python calls, and kept on disk."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numba import types

from wildscav_engine.compilation import compiler
from wildscav_engine.compilation.kernel import PLAIN, array_kernel, disjoint_kernel, kernel
from wildscav_engine.compilation.linking import BitcodeLibrary

pytestmark = pytest.mark.skipif(PLAIN, reason="nothing is compiled")


def half(x):
    return 0.5 * x


_half = kernel(half)


def quarter(x):
    return _half(_half(x))


_quarter = kernel(quarter)


def sum_of_quarters(numbers):
    total = 0.0
    for number in numbers:
        total += _quarter(number)
    return total


@pytest.fixture(autouse=True)
def own_cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(compiler, "cache_folder", lambda file: tmp_path)
    define(monkeypatch)


def define(monkeypatch: pytest.MonkeyPatch) -> None:
    """Make the kernels anew, as a new process would."""
    monkeypatch.setitem(globals(), "_half", kernel(half))
    monkeypatch.setitem(globals(), "_quarter", kernel(quarter))


def hits(compiled: Any) -> int:
    return sum(compiled.inner.stats.cache_hits.values())


def test_a_kernel_runs_with_all_parts_below_it() -> None:
    assert kernel(sum_of_quarters)(np.array([4.0, 8.0])) == 3.0
    assert kernel(quarter)(8.0) == 2.0


def test_parts_are_not_made_machine_code() -> None:
    kernel(sum_of_quarters)(np.array([4.0, 8.0]))
    for part in (_half, _quarter):
        (result,) = part.inner.overloads.values()
        assert isinstance(result.library, BitcodeLibrary)
        assert result.library.get_pointer_to_function(result.fndesc.llvm_func_name) == 0


def test_kept_parts_are_compiled_no_second_time(monkeypatch: pytest.MonkeyPatch) -> None:
    array_kernel(sum_of_quarters)(np.array([4.0, 8.0]))
    define(monkeypatch)

    assert kernel(sum_of_quarters)(np.array([4.0, 8.0])) == 3.0

    assert hits(_quarter) == 1
    assert hits(_half) == 0  # came with the quarter


def test_a_part_is_compiled_for_each_kind_of_argument() -> None:
    assert kernel(quarter)(8) == 2.0
    assert kernel(quarter)(8.0) == 2.0
    assert set(_half.inner.overloads) == {(types.int64,), (types.float64,)}


def add_one(numbers, sums):
    for place in range(numbers.shape[0]):
        sums[place] = numbers[place] + 1.0


_add_one = kernel(add_one)


def add_two(numbers, sums, between):
    _add_one(numbers, between)
    _add_one(between, sums)


@pytest.mark.parametrize("kind", [kernel, disjoint_kernel])
def test_only_disjoint_kernels_tell_the_compiler_that_arrays_share_no_memory(
    kind: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    sums = np.zeros(40)
    monkeypatch.setitem(globals(), "_add_one", kind(add_one))
    kernel(add_two)(np.arange(40.0), sums, np.zeros(40))
    assert sums.tolist() == list(range(2, 42))
    (result,) = _add_one.inner.overloads.values()
    lines = str(result.library._final_module).splitlines()
    (head,) = [line for line in lines if line.startswith("define") and result.fndesc.mangled_name in line]
    assert ("noalias captures(none) %arg" in head) == (kind is disjoint_kernel), head
