"""What can be done with webhooks: register, list and remove them, and queue messages for them."""

import secrets
from base64 import b64encode
from collections.abc import Mapping
from datetime import datetime
from typing import Any

import httpx
from sqlalchemy import delete, select
from sqlalchemy.orm import Session

from wildscav_leaderboard.seasons.refusals import InvalidError, NotFoundError, RefusalError
from wildscav_leaderboard.teams.models import Team
from wildscav_leaderboard.webhooks.models import Delivery, Webhook

LONGEST_URL = 500
SCHEMES = ("https", "http")
HIGHEST_PORT = 65_535
MAX_WEBHOOKS = 5  # webhooks of a team


def add_webhook(session: Session, team: Team, url: str, now: datetime) -> Webhook:
    """Register an address of a team. The secret of the webhook is shown once.

    Raises:
        RefusalError: The address is not valid, or the team has too many.
    """
    _check_url(url)
    if len(webhooks_of(session, team)) >= MAX_WEBHOOKS:
        raise RefusalError(f"a team has at most {MAX_WEBHOOKS} webhooks: remove one first")
    secret = f"whsec_{b64encode(secrets.token_bytes(32)).decode()}"
    webhook = Webhook(team_id=team.id, url=url, secret=secret, created=now)
    session.add(webhook)
    session.flush()
    return webhook


def _check_url(url: str) -> None:
    """Refuse what is no address of a receiver. Where it leads is checked whenever a message is sent."""
    try:
        parsed = httpx.URL(url)
        _ = parsed.host
    except httpx.InvalidURL:
        parsed = httpx.URL("")
    except UnicodeError as error:
        raise InvalidError(f"the name in the address of a webhook is not valid: {error}") from None
    if not url.isprintable() or len(url) > LONGEST_URL or parsed.scheme not in SCHEMES or not parsed.host:
        raise InvalidError(
            f"the address of a webhook must begin with https:// or http:// and have at most {LONGEST_URL} "
            "characters"
        )
    if parsed.port is not None and not 1 <= parsed.port <= HIGHEST_PORT:
        raise InvalidError(f"the port of a webhook is {parsed.port}, must be 1 to {HIGHEST_PORT}")
    if parsed.userinfo:
        raise InvalidError("the address of a webhook must not contain a name or a password")


def webhooks_of(session: Session, team: Team) -> list[Webhook]:
    """Return the webhooks of a team."""
    return list(session.scalars(select(Webhook).filter_by(team_id=team.id).order_by(Webhook.id)))


def own_webhook(session: Session, team: Team, webhook: int) -> Webhook:
    """Return a webhook of a team.

    Raises:
        NotFoundError: It has no such webhook.
    """
    found = session.get(Webhook, webhook)
    if found is None or found.team_id != team.id:
        raise NotFoundError(f"your team has no webhook {webhook}")
    return found


def remove_webhook(session: Session, team: Team, webhook: int) -> None:
    """Remove a webhook of a team, and the messages that wait for it.

    Raises:
        NotFoundError: It has no such webhook.
    """
    found = own_webhook(session, team, webhook)
    session.execute(delete(Delivery).filter_by(webhook_id=found.id))
    session.delete(found)


def queue_message(
    session: Session, team_id: int, kind: str, data: Mapping[str, Any], now: datetime
) -> list[Delivery]:
    """Queue a message for all webhooks of a team that are in use.

    Args:
        session: A writing session: the message is sent if and only if what it reports is stored.
        kind: What happened, such as "submission.active".
    """
    used = session.scalars(select(Webhook).filter_by(team_id=team_id, disabled=None).order_by(Webhook.id))
    queued = [queue_for(session, webhook, kind, data, now) for webhook in used]
    session.flush()
    return queued


def queue_for(
    session: Session, webhook: Webhook, kind: str, data: Mapping[str, Any], now: datetime
) -> Delivery:
    """Queue a message for one webhook."""
    delivery = Delivery(
        webhook_id=webhook.id,
        event=f"msg_{secrets.token_hex(16)}",
        created=now,
        payload={"type": kind, "timestamp": now.isoformat(), "data": dict(data)},
        next_at=now,
    )
    session.add(delivery)
    return delivery
