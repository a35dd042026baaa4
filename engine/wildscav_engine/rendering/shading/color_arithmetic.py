"""Arithmetic with colours and vectors in kernels; colours are red, green and blue, 0-255, as floats."""

from wildscav_engine.compilation.kernel import kernel

Color = tuple[float, float, float]
Vector = tuple[float, float, float]


@kernel
def lerp(first: Color, second: Color, share: float) -> Color:
    """Return the linear blend of two colours, by the share of the second."""
    return (
        first[0] + (second[0] - first[0]) * share,
        first[1] + (second[1] - first[1]) * share,
        first[2] + (second[2] - first[2]) * share,
    )


@kernel
def scaled(color: Color, factor: float) -> Color:
    """Return a colour multiplied by a factor."""
    return color[0] * factor, color[1] * factor, color[2] * factor


@kernel
def clamp(value: float, low: float, high: float) -> float:
    """Return a number limited to a range."""
    return min(high, max(low, value))


@kernel
def dot(first: Vector, second: Vector) -> float:
    """Return the scalar product."""
    return first[0] * second[0] + first[1] * second[1] + first[2] * second[2]
