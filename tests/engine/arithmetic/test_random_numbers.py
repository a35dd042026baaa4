"""The random numbers are Philox4x32-10, keyed by their purpose."""

from itertools import product

import numpy as np
import pytest

from wildscav_engine.arithmetic import random_numbers
from wildscav_engine.arithmetic.random_numbers import (
    RandomStream,
    Stream,
    integer_in,
    normal,
    philox,
    uniform,
)

PI = (0x243F6A88, 0x85A308D3, 0x13198A2E, 0x03707344)  # its first digits


@pytest.mark.parametrize(
    ("seed", "counter", "words"),
    # The known answers published by the authors of the algorithm (Random123, kat_vectors).
    [
        (0, (0, 0, 0, 0), (0x6627E8D5E169C58D, 0xBC57AC4C9B00DBD8)),
        (2**64 - 1, (2**32 - 1,) * 4, (0x408F276D41C83B0E, 0xA20BC7C66D5451FD)),
        (0x299F31D0A4093822, PI, (0xD16CFE0994FDCCEB, 0x5001E42024126EA1)),
    ],
)
def test_the_published_answers(seed: int, counter: tuple[int, ...], words: tuple[int, int]) -> None:
    assert tuple(int(word) for word in philox(np.uint64(seed), *counter)) == words


def test_uniform_numbers_fill_the_unit_interval_evenly() -> None:
    numbers = np.array([uniform(np.uint64(7), Stream.ROBOT, 0, 0, draw) for draw in range(20_000)])
    assert numbers.min() >= 0.0
    assert numbers.max() < 1.0
    assert np.histogram(numbers, 10, (0, 1))[0].min() > 1800


def test_whole_numbers_include_both_ends() -> None:
    drawn = {integer_in(1, 5, np.uint64(3), Stream.ROBOT, frame, 0, 0) for frame in range(200)}
    assert drawn == {1, 2, 3, 4, 5}


def test_normal_numbers_have_mean_zero_and_deviation_one() -> None:
    numbers = np.array([normal(np.uint64(1), Stream.ROBOT, 0, 0, draw) for draw in range(20_000)])
    assert abs(numbers.mean()) < 0.03
    assert numbers.std() == pytest.approx(1.0, abs=0.03)


def test_streams_and_agents_draw_apart() -> None:
    keys = product((Stream.STARTS, Stream.TARGET), range(3), range(3))
    assert len({uniform(np.uint64(9), *key, 0) for key in keys}) == 18


def test_dice_repeat_from_the_same_seed() -> None:
    first, second = RandomStream(5, Stream.HOUSES), RandomStream(5, Stream.HOUSES)
    assert [first.integer(0, 99) for _ in range(20)] == [second.integer(0, 99) for _ in range(20)]
    assert RandomStream(6, Stream.HOUSES).word() != RandomStream(5, Stream.HOUSES).word()


def test_the_random_stream_keeps_its_old_name_for_a_release() -> None:
    with pytest.warns(DeprecationWarning, match="RandomStream"):
        assert random_numbers.Dice is RandomStream
