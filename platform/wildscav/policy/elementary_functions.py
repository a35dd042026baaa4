"""Trigonometry, exponential and logarithm with the same bits as the engine's. Angles are in degrees.

The C library's functions differ in the last bit between machines, and an agent's installation has neither
the engine nor its compiler. Tests check that these equal
``wildscav_engine.arithmetic.elementary_functions``, which explains the series.
"""

import math

RADIANS = 0.017453292519943295  # of one degree
DEGREES = 57.29577951308232  # of one radian
LN2_HIGH, LN2_LOW = 6.93147180369123816490e-01, 1.90821492927058770002e-10  # their sum is ln 2
SQRT_HALF = 0.7071067811865476
TAN_15 = 0.2679491924311227  # tangent of 15°
ROOT_3 = math.sqrt(3.0)
_SINE = (6227020800.0, 39916800.0, 362880.0, 5040.0, 120.0, 6.0)  # 13!, 11!, … 3!
_COSINE = (87178291200.0, 479001600.0, 3628800.0, 40320.0, 720.0, 24.0)  # 14!, 12!, … 4!


def sine(angle: float) -> float:
    """Return the sine of a finite angle in degrees."""
    return _sine_of_turn(math.fmod(angle, 360.0))


def cosine(angle: float) -> float:
    """Return the cosine of a finite angle in degrees."""
    return _sine_of_turn(math.fmod(angle, 360.0) + 90.0)


def arctangent(y: float, x: float) -> float:
    """Return the angle of (x, y) from the x axis in (-180, 180] degrees; 0 for the zero vector."""
    across, along = abs(y), abs(x)
    if across == 0.0 and along == 0.0:
        return 0.0
    ratio = min(across, along) / max(across, along)
    if ratio > TAN_15:
        angle = 30.0 + _arctangent_of_small((ratio * ROOT_3 - 1.0) / (ratio + ROOT_3)) * DEGREES
    else:
        angle = _arctangent_of_small(ratio) * DEGREES
    if across > along:
        angle = 90.0 - angle
    if x < 0.0:
        angle = 180.0 - angle
    return -angle if y < 0.0 else angle


def exponential(x: float) -> float:
    """Return e to the power of x, for x up to 700; 0 below -700."""
    if x < -700.0:
        return 0.0
    halvings = math.floor(x / (LN2_HIGH + LN2_LOW) + 0.5)
    rest = (x - halvings * LN2_HIGH) - halvings * LN2_LOW
    total = 1.0
    for term in range(18, 0, -1):
        total = 1.0 + total * rest / term
    return math.ldexp(total, halvings)


def logarithm(x: float) -> float:
    """Return the natural logarithm of x > 0; -inf for 0."""
    if x <= 0.0:
        return -math.inf
    mantissa, doublings = math.frexp(x)  # from 0.5 to 1
    if mantissa < SQRT_HALF or (mantissa == SQRT_HALF and x > 1.0):  # as the engine, which halves and doubles
        mantissa, doublings = mantissa * 2.0, doublings - 1
    share = (mantissa - 1.0) / (mantissa + 1.0)
    square = share * share
    total = 0.0
    for power in range(23, 0, -2):
        total = 1.0 / power + square * total
    return (doublings * LN2_LOW + 2.0 * share * total) + doublings * LN2_HIGH


def _sine_of_turn(angle: float) -> float:
    quarter = math.floor(angle / 90.0 + 0.5)
    rest = (angle - 90.0 * quarter) * RADIANS
    turn = quarter % 4
    value = _cosine_of_small(rest) if turn % 2 else _sine_of_small(rest)
    return value if turn < 2 else -value


def _sine_of_small(radians: float) -> float:
    square = radians * radians
    tail = 1.0 / _SINE[0] - square / 1307674368000.0
    for place, factorial in enumerate(_SINE[1:]):
        tail = (-1.0 if place % 2 == 0 else 1.0) / factorial + square * tail
    return radians + radians * square * tail


def _cosine_of_small(radians: float) -> float:
    square = radians * radians
    tail = -1.0 / _COSINE[0] + square / 20922789888000.0
    for place, factorial in enumerate(_COSINE[1:]):
        tail = (1.0 if place % 2 == 0 else -1.0) / factorial + square * tail
    tail = -0.5 + square * tail
    return 1.0 + square * tail


def _arctangent_of_small(x: float) -> float:
    square = x * x
    total = 0.0
    for power in range(27, 0, -2):
        total = (1.0 if power % 4 == 1 else -1.0) / power + square * total
    return x * total
