"""The engine's elementary functions agree with the C library's to the last digits."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from wildscav_engine.arithmetic import elementary_functions as trig

ANGLES = st.floats(-1e4, 1e4)


@given(ANGLES)
def test_sine_and_cosine_are_right_and_wrapping_keeps_the_direction(angle: float) -> None:
    for same in (angle, trig.wrap(angle)):
        assert trig.sine(same) == pytest.approx(math.sin(math.radians(angle)), abs=1e-10)
        assert trig.cosine(same) == pytest.approx(math.cos(math.radians(angle)), abs=1e-10)
    assert trig.sine(angle) == pytest.approx(math.sin(math.radians(angle)), abs=2e-12)
    assert trig.cosine(angle) == pytest.approx(math.cos(math.radians(angle)), abs=2e-12)


@pytest.mark.parametrize(("angle", "sine", "cosine"), [(0, 0, 1), (90, 1, 0), (180, 0, -1), (-90, -1, 0)])
def test_the_compass_points_are_exact(angle: float, sine: float, cosine: float) -> None:
    assert (trig.sine(float(angle)), trig.cosine(float(angle))) == (sine, cosine)


@given(st.floats(-1e3, 1e3), st.floats(-1e3, 1e3))
def test_arctangent_is_right(y: float, x: float) -> None:
    wanted = math.degrees(math.atan2(y, x)) if (x, y) != (0.0, 0.0) else 0.0
    assert abs(trig.wrap(trig.arctangent(y, x) - wanted)) < 1e-11


@given(st.floats(-700, 300))
def test_exponential_is_right(x: float) -> None:
    assert trig.exponential(x) == pytest.approx(math.exp(x), rel=1e-13)


@given(st.floats(1e-300, 1e300))
def test_logarithm_is_right(x: float) -> None:
    assert trig.logarithm(x) == pytest.approx(math.log(x), rel=1e-13, abs=1e-15)


@pytest.mark.parametrize(
    ("angle", "wrapped"),
    [(0, 0), (180, 180), (-180, 180), (181, -179), (540, 180), (-541, 179), (3600, 0)],
)
def test_angles_wrap_into_minus_180_to_180(angle: float, wrapped: float) -> None:
    assert trig.wrap(float(angle)) == wrapped


@given(st.floats(allow_nan=False, allow_infinity=False))
def test_any_finite_angle_is_a_direction(angle: float) -> None:
    assert -180.0 < trig.wrap(angle) <= 180.0
    assert trig.sine(angle) ** 2 + trig.cosine(angle) ** 2 == pytest.approx(1.0)
