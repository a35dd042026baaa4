"""Trigonometry, exponential and logarithm computed only with + − × ÷ √: the same bits on every machine.

The C library's versions differ between machines in the last bit, which would break exact replay. These
are accurate to about 1e-15 (the tests compare them with the C library), and every operation in them is
exactly rounded by IEEE 754, the remainder ``np.fmod`` included, whose result is always exact. Angles are
degrees, as everywhere in the game.
"""

import math

import numpy as np

from wildscav_engine.compilation.kernel import kernel

RADIANS = 0.017453292519943295  # of one degree
DEGREES = 57.29577951308232  # of one radian
LN2_HIGH, LN2_LOW = 6.93147180369123816490e-01, 1.90821492927058770002e-10  # their sum is ln 2
SQRT_HALF = 0.7071067811865476
TAN_15 = 0.2679491924311227  # tangent of 15°


@kernel
def within_turn(angle: float) -> float:
    """Return any finite angle without its full turns, in (-360, 360) degrees with its sign; exact."""
    return float(np.fmod(angle, 360.0))


@kernel
def wrap(angle: float) -> float:
    """Return any finite angle as the same direction in (-180, 180] degrees."""
    turned = within_turn(angle)
    if turned <= -180.0:
        return turned + 360.0
    if turned > 180.0:
        return turned - 360.0
    return turned


@kernel
def _sine_of_small(radians: float) -> float:
    """Return the sine by its Taylor series; the error is below 1e-17 up to 45°."""
    x2 = radians * radians
    tail = 1.0 / 6227020800.0 - x2 / 1307674368000.0
    tail = -1.0 / 39916800.0 + x2 * tail
    tail = 1.0 / 362880.0 + x2 * tail
    tail = -1.0 / 5040.0 + x2 * tail
    tail = 1.0 / 120.0 + x2 * tail
    tail = -1.0 / 6.0 + x2 * tail
    return radians + radians * x2 * tail


@kernel
def _cosine_of_small(radians: float) -> float:
    """Return the cosine by its Taylor series; the error is below 1e-17 up to 45°."""
    x2 = radians * radians
    tail = -1.0 / 87178291200.0 + x2 / 20922789888000.0
    tail = 1.0 / 479001600.0 + x2 * tail
    tail = -1.0 / 3628800.0 + x2 * tail
    tail = 1.0 / 40320.0 + x2 * tail
    tail = -1.0 / 720.0 + x2 * tail
    tail = 1.0 / 24.0 + x2 * tail
    tail = -0.5 + x2 * tail
    return 1.0 + x2 * tail


@kernel
def sine(angle: float) -> float:
    """Return the sine of any finite angle in degrees; exact at multiples of 90°."""
    return _sine_of_turn(within_turn(angle))


@kernel
def _sine_of_turn(angle: float) -> float:
    quarter = math.floor(angle / 90.0 + 0.5)
    rest = (angle - 90.0 * quarter) * RADIANS
    turn = int(quarter - 4.0 * math.floor(quarter / 4.0))
    if turn == 0:
        return _sine_of_small(rest)
    if turn == 1:
        return _cosine_of_small(rest)
    if turn == 2:
        return -_sine_of_small(rest)
    return -_cosine_of_small(rest)


@kernel
def cosine(angle: float) -> float:
    """Return the cosine of an angle in degrees; exact at multiples of 90°."""
    return _sine_of_turn(within_turn(angle) + 90.0)


@kernel
def _arctangent_of_small(x: float) -> float:
    """Return the arctangent in radians by its Taylor series, for |x| <= tan 15°; the error is below 1e-16."""
    x2 = x * x
    total = 0.0
    for power in range(27, 0, -2):
        sign = 1.0 if power % 4 == 1 else -1.0
        total = sign / power + x2 * total
    return x * total


@kernel
def arctangent(y: float, x: float) -> float:
    """Return the angle of (x, y) from the x axis in (-180, 180] degrees; 0 for the zero vector.

    ``arctangent(dx, dz)`` is a yaw. Reduced to |t| <= tan 15° by atan t = 30° + atan((t√3 - 1) / (t + √3)).
    """
    across, along = abs(y), abs(x)
    if across == 0.0 and along == 0.0:
        return 0.0
    ratio = min(across, along) / max(across, along)
    if ratio > TAN_15:
        root = math.sqrt(3.0)
        angle = 30.0 + _arctangent_of_small((ratio * root - 1.0) / (ratio + root)) * DEGREES
    else:
        angle = _arctangent_of_small(ratio) * DEGREES
    if across > along:
        angle = 90.0 - angle
    if x < 0.0:
        angle = 180.0 - angle
    return -angle if y < 0.0 else angle


@kernel
def exponential(x: float) -> float:
    """Return e to the power of x, for x up to 700; 0 below -700."""
    if x < -700.0:
        return 0.0
    halvings = math.floor(x / (LN2_HIGH + LN2_LOW) + 0.5)
    rest = (x - halvings * LN2_HIGH) - halvings * LN2_LOW
    total = 1.0
    for term in range(18, 0, -1):
        total = 1.0 + total * rest / term
    return total * power_of_two(int(halvings))


@kernel
def power_of_two(exponent: int) -> float:
    """Return two to the power of an integer, exactly."""
    factor = 2.0 if exponent > 0 else 0.5
    result = 1.0
    for _ in range(abs(exponent)):
        result *= factor
    return result


@kernel
def logarithm(x: float) -> float:
    """Return the natural logarithm of x > 0; -inf for 0.

    With x = m · 2^k and m near 1: ln m = 2 artanh((m - 1) / (m + 1)).
    """
    if x <= 0.0:
        return -math.inf
    doublings = 0
    mantissa = x
    while mantissa > 2.0 * SQRT_HALF:
        mantissa *= 0.5
        doublings += 1
    while mantissa < SQRT_HALF:
        mantissa *= 2.0
        doublings -= 1
    s = (mantissa - 1.0) / (mantissa + 1.0)
    s2 = s * s
    total = 0.0
    for power in range(23, 0, -2):
        total = 1.0 / power + s2 * total
    return (doublings * LN2_LOW + 2.0 * s * total) + doublings * LN2_HIGH
