"""The SDK's functions are the engine's, bit for bit."""

import struct

from hypothesis import given
from hypothesis import strategies as some

from wildscav.policy import elementary_functions as own
from wildscav_engine.arithmetic import elementary_functions as exact

SQRT_HALF = exact.SQRT_HALF
ANGLES = some.floats(-1e6, 1e6) | some.integers(-24, 24).map(lambda part: 15.0 * part)
NUMBERS = some.floats(-1.0, 1.0)


def bits(number: float) -> bytes:
    return struct.pack("<d", number)


@given(ANGLES)
def test_sine_and_cosine(angle: float) -> None:
    assert bits(own.sine(angle)) == bits(exact.sine(angle))
    assert bits(own.cosine(angle)) == bits(exact.cosine(angle))


@given(NUMBERS, NUMBERS)
def test_arctangent(y: float, x: float) -> None:
    assert bits(own.arctangent(y, x)) == bits(exact.arctangent(y, x))


@given(some.floats(-800.0, 700.0))
def test_exponential(x: float) -> None:
    assert bits(own.exponential(x)) == bits(exact.exponential(x))


@given(
    some.floats(0.0, 1e9, allow_subnormal=False) | some.integers(-30, 30).map(lambda k: SQRT_HALF * 2.0**k)
)
def test_logarithm(x: float) -> None:
    assert bits(own.logarithm(x)) == bits(exact.logarithm(x))
