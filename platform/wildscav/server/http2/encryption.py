"""TLS on one connection: bytes in, bytes out. Whoever reads and writes them decides when."""

import ssl
from contextlib import suppress

CHUNK = 65_536  # bytes decrypted at a time


class Encryption:
    """The server's end of TLS on one connection.

    What a client sends is decrypted by whoever read it, so that this counts as time taken for that client;
    asyncio's own TLS would do it before anybody could ask whose it is.

    Args:
        context: With the server's certificate.
    """

    def __init__(self, context: ssl.SSLContext) -> None:
        self._incoming, self._outgoing = ssl.MemoryBIO(), ssl.MemoryBIO()
        self._object = context.wrap_bio(self._incoming, self._outgoing, server_side=True)
        self.is_ready = False  # whether the handshake is done
        self.has_ended = False  # whether the client has said that it sends no more

    def decrypt(self, content: bytes) -> bytes:
        """Take what the client sent, and return what of it is not TLS's own.

        Args:
            content: As it was read.

        Returns:
            Decrypted bytes; none while the handshake lasts, or if a record is not complete.

        Raises:
            ssl.SSLError: It is not TLS, or not from a client that may come in.
        """
        self._incoming.write(content)
        pieces = []
        try:
            if not self.is_ready:
                self._object.do_handshake()
                self.is_ready = True
            while piece := self._object.read(CHUNK):
                pieces.append(piece)
            self.has_ended = True
        except ssl.SSLWantReadError:
            pass
        except ssl.SSLZeroReturnError:
            self.has_ended = True
        return b"".join(pieces)

    def encrypt(self, content: bytes) -> bytes:
        """Return what to send, so that the client reads a content; the handshake must be done."""
        rest = memoryview(content)
        while rest:
            rest = rest[self._object.write(rest) :]  # a record at a time
        return self._outgoing.read()

    def own_words(self) -> bytes:
        """Return what TLS itself has to send: of a handshake, or of an error."""
        return self._outgoing.read()

    def end(self) -> bytes:
        """Return what to send last."""
        with suppress(ssl.SSLError):  # the client need not say goodbye, too
            self._object.unwrap()
        return self._outgoing.read()
