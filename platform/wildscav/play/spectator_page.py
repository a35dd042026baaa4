"""The page of a spectator, who sees through any eyes and does nothing."""

from starlette.websockets import WebSocket

from wildscav.play.inputs import InputError, Seen, Watch, decode_of_spectator
from wildscav.play.page import TOO_MANY, UNSUPPORTED, OpenPage, PageClosedError
from wildscav.play.table import MOST_SPECTATORS, Table


class SpectatorPage(OpenPage):
    """Serves a spectator's page until it is closed.

    Args:
        socket: The page's connection, which was accepted.
        table: The table.
    """

    def __init__(self, socket: WebSocket, table: Table) -> None:
        super().__init__(socket)
        self._table, self._gallery = table, table.gallery

    async def serve(self) -> None:
        """Serve the page until it is closed."""
        if not self._table.admit(self):
            return await self._socket.close(TOO_MANY, f"{MOST_SPECTATORS} people watch already")
        self._gallery.watch(self, None)
        try:
            await self._serve(self._receive(), self._send_pictures())
        finally:
            self._gallery.leave(self)
            self._table.dismiss(self)

    async def _send_pictures(self) -> None:
        number = 0
        while True:
            hung = await self._gallery.next(self, number)
            number = hung.number
            delay = None if self.round_trip is None else 1000.0 * self.round_trip
            await self._send_picture({"delay": delay, **hung.shown}, hung.picture)

    async def _receive(self) -> None:
        async for text in self._texts():
            try:
                message = decode_of_spectator(text)
            except InputError as error:
                raise PageClosedError(UNSUPPORTED, f"spectators only watch: {error}") from None
            match message:
                case Seen():
                    self._note_seen(message.picture)
                case Watch():
                    self._gallery.watch(self, message.seat)
