"""TLS on one connection, whose data the connection itself decrypts."""

import contextlib
import ssl

CHUNK = 65_536  # bytes read or decrypted at a time


class Encryption:
    """The server's side of TLS on one connection.

    The connection itself decrypts its data, so that the time is charged to its client; asyncio's own TLS
    would decrypt it before the connection is called.
    """

    def __init__(self, context: ssl.SSLContext) -> None:
        self._incoming, self._outgoing = ssl.MemoryBIO(), ssl.MemoryBIO()
        self._object = context.wrap_bio(self._incoming, self._outgoing, server_side=True)
        self.is_ready = False  # whether the handshake is done
        self.has_ended = False  # whether the client has announced that it sends no more

    def decrypt(self, content: bytes) -> bytes:
        """Process data from the client, and return the decrypted content.

        Returns:
            Decrypted bytes; none during the handshake, or while a record is incomplete.

        Raises:
            ssl.SSLError: The data is not valid TLS, or the client's certificate is not accepted.
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
        """Return content as encrypted bytes to send; the handshake must be done."""
        rest = memoryview(content)
        while rest:
            rest = rest[self._object.write(rest) :]  # a record at a time
        return self._outgoing.read()

    def pending_output(self) -> bytes:
        """Return the bytes that TLS itself has to send, for a handshake or an error."""
        return self._outgoing.read()

    def end(self) -> bytes:
        """Return the bytes that end TLS."""
        with contextlib.suppress(ssl.SSLError):  # the client need not answer
            self._object.unwrap()
        return self._outgoing.read()
