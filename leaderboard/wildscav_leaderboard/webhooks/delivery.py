"""Sending the messages that wait for webhooks, again and again until they arrive or are given up.

Everything that is known about a message is in the database, so a restart loses none. A message that arrived
just before a crash is sent once more, with the same identifier.
"""

import asyncio
import threading
from collections.abc import Iterable
from datetime import UTC, datetime, timedelta
from hashlib import blake2b
from typing import Self

from sqlalchemy import func, select, update
from sqlalchemy.orm import Session

from wildscav.monitoring.logs import Log, open_log
from wildscav_leaderboard.database.connection import Database, DatabaseError
from wildscav_leaderboard.seasons.settings import Webhooks
from wildscav_leaderboard.webhooks.models import Delivery, Webhook
from wildscav_leaderboard.webhooks.sending import Answer, Message, send_all

AT_ONCE = 32  # webhooks that are sent to at the same time
MOST_ATTEMPTS = 8  # at each message
FIRST_PAUSE, FACTOR = 5.0, 4.0  # s before the second attempt, and how much longer each pause is than the last
JITTER = 0.25  # of a pause, by which it is longer at most
MOST_LOST = 3  # messages in a row that were given up, after which a webhook is disabled
LOOK_INTERVAL = 1.0  # s between two looks at what is due


def deliver_due(database: Database, settings: Webhooks, now: datetime) -> int:
    """Send the messages that are due, one for each webhook, and note how it went.

    Returns:
        How many were sent, or could not be.
    """
    with database.reading() as session:
        messages = due(session, now)
    if not messages:
        return 0
    answers = asyncio.run(send_all(messages, now, private_addresses=settings.private_addresses))
    with database.writing() as session:
        note(session, answers, now)
    return len(answers)


def due(session: Session, now: datetime) -> list[Message]:
    """Return the message of each webhook that has waited longest of those that are due."""
    rank = func.row_number().over(partition_by=Delivery.webhook_id, order_by=(Delivery.next_at, Delivery.id))
    ranked = select(Delivery.id, rank.label("rank")).where(Delivery.next_at <= now).subquery()
    wanted = (
        select(Delivery, Webhook)
        .join(Webhook, Webhook.id == Delivery.webhook_id)
        .join(ranked, ranked.c.id == Delivery.id)
        .where(ranked.c.rank == 1)
        .order_by(Delivery.next_at, Delivery.id)
        .limit(AT_ONCE)
    )
    return [
        Message(one.id, one.event, webhook.url, webhook.secret, one.payload)
        for one, webhook in session.execute(wanted)
    ]


def note(session: Session, answers: Iterable[Answer], now: datetime) -> None:
    """Note how attempts went, and when each message is sent next."""
    for answer in answers:
        delivery = session.get(Delivery, answer.delivery)
        if delivery is None or delivery.next_at is None:
            continue  # its webhook was removed meanwhile, or it was settled by an earlier answer
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
                _disable(session, webhook, f"{MOST_LOST} messages in a row did not arrive: {answer.problem}")


def next_attempt(event: str, attempts: int, now: datetime) -> datetime | None:
    """Return when a message is sent again, or None if it is given up.

    Args:
        event: The message's identifier. It decides by how much the pause is longer than the least, so that
            messages that failed together are not all sent again together.
        attempts: How often it was sent.
        now: The time of the last attempt.
    """
    if attempts >= MOST_ATTEMPTS:
        return None
    draw = int.from_bytes(blake2b(f"{event} {attempts}".encode(), digest_size=4).digest()) / 2**32
    pause = FIRST_PAUSE * FACTOR ** (attempts - 1)
    return now + timedelta(seconds=pause * (1.0 + JITTER * draw))


def _is_lost(session: Session, webhook: Webhook) -> bool:
    """Return whether the newest messages of a webhook that are no longer sent did not arrive."""
    session.flush()
    ended = select(Delivery).filter_by(webhook_id=webhook.id, next_at=None).order_by(Delivery.id.desc())
    newest = session.scalars(ended.limit(MOST_LOST)).all()
    return len(newest) == MOST_LOST and all(one.delivered is None for one in newest)


def _disable(session: Session, webhook: Webhook, reason: str) -> None:
    """Give up all messages to a webhook, until a test message arrives there."""
    webhook.disabled = reason
    session.execute(update(Delivery).filter_by(webhook_id=webhook.id).values(next_at=None))


class Deliverer:
    """A thread that sends messages for as long as the context lasts.

    Args:
        database: The season's database.
        settings: The season's settings of webhooks; if they are not enabled, nothing is sent.
        log: Where to report that the database cannot be used.
    """

    def __init__(self, database: Database, settings: Webhooks, log: Log | None = None) -> None:
        self._database, self._settings = database, settings
        self._log = log or open_log(None)
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._run, name="webhooks", daemon=True)

    def __enter__(self) -> Self:
        if self._settings.enabled:
            self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        """Stop after the messages that are being sent now."""
        self._ended.set()
        if self._settings.enabled:
            self._thread.join()

    def _run(self) -> None:
        while not self._ended.is_set():
            try:
                sent = deliver_due(self._database, self._settings, datetime.now(UTC))
            except DatabaseError as error:
                self._log.warning("webhooks_wait", reason=str(error))
                sent = 0
            if not sent:
                self._ended.wait(LOOK_INTERVAL)
