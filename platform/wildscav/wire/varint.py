"""Integers in protobuf's wire format."""


def encode_varint(number: int) -> bytes:
    """Return a number, at least 0, as protobuf writes it: seven bits per byte, the lowest bits first."""
    parts = bytearray()
    while number > 127:
        parts.append(number & 127 | 128)
        number >>= 7
    parts.append(number)
    return bytes(parts)
