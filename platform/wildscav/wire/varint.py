"""Whole numbers in protobuf's wire format."""


def encode_varint(number: int) -> bytes:
    """Return a number from 0 on as protobuf writes it: seven bits a byte, the lowest first."""
    parts = bytearray()
    while number > 127:
        parts.append(number & 127 | 128)
        number >>= 7
    parts.append(number)
    return bytes(parts)
