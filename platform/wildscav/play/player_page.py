"""The page of a person who plays: pictures from the seat's eyes, and inputs from keys, mouse and fingers."""

import asyncio
from concurrent.futures import ThreadPoolExecutor

from starlette.websockets import WebSocket

from wildscav.play.inputs import (
    Input,
    InputError,
    Pause,
    Rename,
    Renew,
    Seen,
    Start,
    decode_message,
)
from wildscav.play.lobby import LobbyError
from wildscav.play.page import POLICY_VIOLATION, UNSUPPORTED, Allowance, OpenPage, PageClosedError
from wildscav.play.table import Table

MOST_COMMANDS = 10  # a second: whatever is told to everybody


class PlayerPage(OpenPage):
    """Serves the page of a seat until it is closed.

    Args:
        socket: The page's connection, which was accepted.
        table: The table.
        seat: The seat of the page's person.
    """

    def __init__(self, socket: WebSocket, table: Table, seat: int) -> None:
        super().__init__(socket)
        self._table, self._seat = table, seat
        self._chair = table.lobby.chairs[seat]
        self._commands = Allowance(MOST_COMMANDS)

    async def serve(self) -> None:
        """Serve the page until it is closed, or another page takes its place."""
        self._table.attach(self._seat, self)
        try:
            await self._serve(self._receive(), self._send_pictures())
        finally:
            self._table.detach(self._seat, self)

    async def _send_pictures(self) -> None:
        """Send a picture whenever there is something new to see, and the page has shown the last ones."""
        loop, person, eyes = asyncio.get_running_loop(), self._chair.person, self._chair.eyes
        # A thread of its own, which keeps the memory that pictures are made in.
        with ThreadPoolExecutor(1, "pictures") as painter:
            while True:
                view = await person.look()
                picture = await loop.run_in_executor(painter, eyes.picture, view.moment)
                await self._send_picture({"input": view.taken, **view.display}, picture)

    async def _receive(self) -> None:
        async for text in self._texts():
            try:
                message = decode_message(text)
            except InputError as error:
                raise PageClosedError(UNSUPPORTED, str(error)) from None
            match message:
                case Input():
                    self._chair.person.controls.receive(message)
                case Seen():
                    self._note_seen(message.picture)
                case _:
                    self._command(message)

    def _command(self, message: Start | Pause | Rename | Renew) -> None:
        """Do what everybody is told of."""
        if not self._commands.count():
            raise PageClosedError(POLICY_VIOLATION, "too many messages")
        try:
            match message:
                case Start():
                    self._table.start(self._seat)
                case Pause():
                    self._table.pause(message.paused)
                case Rename():
                    self._table.rename(self._seat, message.name)
                case Renew():
                    self._table.renew(self._seat, message.seat)
        except LobbyError as error:
            self.tell({"kind": "refused", "message": str(error)})
