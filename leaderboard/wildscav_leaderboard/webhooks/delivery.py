"""Sending the messages that wait for webhooks, again and again until they arrive or are given up.

Each message is sent in a task of its own, so a webhook that is slow or broken holds up no other one.

Everything that is known about a message is in the database, so a restart loses none. A message that arrived
just before a crash is sent once more, with the same identifier.
"""

import asyncio
import threading
from collections.abc import Collection
from datetime import UTC, datetime, timedelta
from hashlib import blake2b
from typing import Self

from sqlalchemy import func, select, update
from sqlalchemy.orm import Session

from wildscav_leaderboard.database.connection import Database, DatabaseError
from wildscav_leaderboard.seasons.settings import Webhooks
from wildscav_leaderboard.seasons.watchdog import watched_thread
from wildscav_leaderboard.webhooks.models import Delivery, Webhook
from wildscav_leaderboard.webhooks.sending import Answer, Message, open_client, send
from wildscav_server.monitoring.logs import Log, open_log

AT_ONCE = 128  # webhooks that are sent to at the same time
MAX_ATTEMPTS = 8  # at each message
FIRST_PAUSE, FACTOR = 5.0, 4.0  # s before the second attempt, and how much longer each pause is than the last
JITTER = 0.25  # of a pause, by which it is longer at most
MAX_LOST = 3  # messages in a row that were given up, after which a webhook is disabled
LOOK_INTERVAL = 1.0  # s between two looks at what is due


def due(session: Session, now: datetime, busy: Collection[int] = ()) -> list[Message]:
    """Return the message of each webhook that has waited longest of those that are due.

    Args:
        busy: Webhooks to which a message is being sent.
    """
    rank = func.row_number().over(partition_by=Delivery.webhook_id, order_by=(Delivery.next_at, Delivery.id))
    ranked = select(Delivery.id, rank.label("rank")).where(Delivery.next_at <= now).subquery()
    wanted = (
        select(Delivery, Webhook)
        .join(Webhook, Webhook.id == Delivery.webhook_id)
        .join(ranked, ranked.c.id == Delivery.id)
        .where(ranked.c.rank == 1, Webhook.id.not_in(busy))
        .order_by(Delivery.next_at, Delivery.id)
        .limit(AT_ONCE - len(busy))
    )
    return [
        Message(one.id, webhook.id, one.event, webhook.url, webhook.secret, one.payload)
        for one, webhook in session.execute(wanted)
    ]


def note(session: Session, answer: Answer, now: datetime) -> None:
    """Note how an attempt went, and when the message is sent next."""
    delivery = session.get(Delivery, answer.delivery)
    if delivery is None or delivery.next_at is None:
        return  # its webhook was removed meanwhile, or it was settled by an earlier answer
    webhook = session.get_one(Webhook, delivery.webhook_id)
    delivery.attempts += 1
    delivery.problem = answer.problem
    if not answer.problem:
        delivery.delivered, delivery.next_at = now, None
        webhook.disabled = None
    elif answer.is_gone:
        _disable(session, webhook, "it answered that it wants no more messages (status 410)")
    else:
        delivery.next_at = next_attempt(delivery.event, delivery.attempts, now)
        if delivery.next_at is None and _is_lost(session, webhook):
            _disable(session, webhook, f"{MAX_LOST} messages in a row did not arrive: {answer.problem}")


def next_attempt(event: str, attempts: int, now: datetime) -> datetime | None:
    """Return when a message is sent again, or None if it is given up.

    Args:
        event: The message's identifier. It decides by how much the pause is longer than the least, so that
            messages that failed together are not all sent again together.
        now: The time of the last attempt.
    """
    if attempts >= MAX_ATTEMPTS:
        return None
    draw = int.from_bytes(blake2b(f"{event} {attempts}".encode(), digest_size=4).digest()) / 2**32
    pause = FIRST_PAUSE * FACTOR ** (attempts - 1)
    return now + timedelta(seconds=pause * (1.0 + JITTER * draw))


def _is_lost(session: Session, webhook: Webhook) -> bool:
    """Return whether the newest messages of a webhook that are no longer sent did not arrive."""
    session.flush()
    ended = select(Delivery).filter_by(webhook_id=webhook.id, next_at=None).order_by(Delivery.id.desc())
    newest = session.scalars(ended.limit(MAX_LOST)).all()
    return len(newest) == MAX_LOST and all(one.delivered is None for one in newest)


def _disable(session: Session, webhook: Webhook, reason: str) -> None:
    """Give up all messages to a webhook, until a test message arrives there."""
    webhook.disabled = reason
    session.execute(update(Delivery).filter_by(webhook_id=webhook.id).values(next_at=None))


class Sender:
    """Sends messages; at the end of the context it waits for those that are being sent.

    Args:
        log: Where to report that the database cannot be used.
    """

    def __init__(self, database: Database, settings: Webhooks, log: Log | None = None) -> None:
        self._database, self._settings = database, settings
        self._log = log or open_log(None)
        self._client = open_client()
        self.sending: dict[int, asyncio.Task[None]] = {}  # by webhook

    async def __aenter__(self) -> Self:
        return self

    async def __aexit__(self, *_: object) -> None:
        await asyncio.gather(*self.sending.values())
        await self._client.aclose()

    async def send_due(self, now: datetime) -> int:
        """Begin to send the messages that are due, one for each webhook; return how many."""
        for webhook, task in list(self.sending.items()):
            if task.done():
                del self.sending[webhook]
                task.result()
        try:
            messages = await asyncio.to_thread(self._due, now)
        except DatabaseError as error:
            self._log.warning("webhooks_wait", reason=str(error))
            return 0
        for message in messages:
            self.sending[message.webhook] = asyncio.create_task(self._send(message, now))
        return len(messages)

    async def _send(self, message: Message, now: datetime) -> None:
        try:
            private = self._settings.private_addresses
            answer = await send(self._client, message, now, private_addresses=private)
            await asyncio.to_thread(self._note, answer, now)
        except DatabaseError as error:  # it is sent once more
            self._log.warning("webhooks_wait", reason=str(error))

    def _due(self, now: datetime) -> list[Message]:
        with self._database.reading() as session:
            return due(session, now, list(self.sending))

    def _note(self, answer: Answer, now: datetime) -> None:
        with self._database.writing() as session:
            note(session, answer, now)


class Deliverer:
    """A thread that sends messages for as long as the context lasts.

    Args:
        settings: The season's settings of webhooks; if they are not enabled, nothing is sent.
    """

    def __init__(self, database: Database, settings: Webhooks, log: Log | None = None) -> None:
        self._database, self._settings, self._log = database, settings, log
        self._ended = threading.Event()
        self._thread = watched_thread(
            "webhooks", lambda: asyncio.run(self._send()), self._ended, database, log
        )

    def __enter__(self) -> Self:
        if self._settings.enabled:
            self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        """Stop after the messages that are being sent now."""
        self._ended.set()
        if self._settings.enabled:
            self._thread.join()

    async def _send(self) -> None:
        async with Sender(self._database, self._settings, self._log) as sender:
            while not self._ended.is_set():
                await sender.send_due(datetime.now(UTC))
                if sender.sending:
                    tasks = list(sender.sending.values())
                    await asyncio.wait(tasks, timeout=LOOK_INTERVAL, return_when=asyncio.FIRST_COMPLETED)
                else:
                    await asyncio.to_thread(self._ended.wait, LOOK_INTERVAL)
