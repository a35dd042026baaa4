"""What can be done with accounts: register, log in, tokens, web sessions, invitations."""

from dataclasses import dataclass
from datetime import datetime, timedelta

from sqlalchemy import delete, select
from sqlalchemy.orm import Session

from wildscav_leaderboard.accounts.models import COMPETITOR, ORGANIZER, Account, Invitation, Token, WebSession
from wildscav_leaderboard.accounts.passwords import INVITATION, TOKEN, digest_of, new_key
from wildscav_leaderboard.seasons.names import checked_line, checked_name
from wildscav_leaderboard.seasons.refusals import (
    ForbiddenError,
    NotFoundError,
    RefusalError,
    UnknownCallerError,
)
from wildscav_leaderboard.seasons.settings import SeasonSettings

SESSION_LASTS = timedelta(days=14)
USED_STEP = timedelta(minutes=10)  # how exactly the last use of a token is known
MAX_TOKENS = 20  # of an account


@dataclass(frozen=True)
class Caller:
    """Who asks."""

    account: Account
    csrf: str | None = None  # the token that forms must carry; None for a program

    @property
    def is_organizer(self) -> bool:
        """Whether they may do privileged acts."""
        return self.account.role == ORGANIZER


def register(
    session: Session,
    settings: SeasonSettings,
    name: str,
    password_hash: str,
    invitation: str | None,
    now: datetime,
) -> Account:
    """Make an account.

    Args:
        session: A writing session.
        invitation: A key; needed unless registration is open.

    Raises:
        RefusalError: The name is taken or not allowed, or the invitation is needed and not valid.
    """
    checked_name(name, "name")
    role = COMPETITOR
    if invitation:
        role = _use_invitation(session, invitation, now)
    elif settings.registration != "open":
        raise ForbiddenError("this season is for invited people: register with the key of an invitation")
    return add_account(session, name, password_hash, role, now)


def add_account(session: Session, name: str, password_hash: str, role: str, now: datetime) -> Account:
    """Make an account without an invitation, as organizers may.

    Raises:
        RefusalError: The name is taken or not allowed.
    """
    checked_name(name, "name")
    if session.scalars(select(Account).filter_by(name=name)).first() is not None:
        raise RefusalError(f"there is already an account {name!r}: choose another name")
    account = Account(name=name, password=password_hash, role=role, created=now)
    session.add(account)
    session.flush()
    return account


def _use_invitation(session: Session, key: str, now: datetime) -> str:
    """Use up one registration of an invitation, and return the role that it gives."""
    found = session.scalars(select(Invitation).filter_by(digest=digest_of(key))).one_or_none()
    if found is None or found.uses_left == 0 or (found.expires is not None and found.expires <= now):
        raise ForbiddenError(
            "this invitation is unknown, used up or expired: ask the organizers for a new one"
        )
    if found.uses_left is not None:
        found.uses_left -= 1
    return found.role


def invite(
    session: Session,
    label: str,
    now: datetime,
    *,
    role: str = COMPETITOR,
    uses: int | None = 1,
    days: int | None = None,
) -> str:
    """Make an invitation, and return its key, which is shown once.

    Args:
        session: A writing session.
        role: Of the accounts that are registered with it.
        uses: How many; None for any number.
        days: After how many it expires; None for never.
    """
    key = new_key(INVITATION)
    label = checked_line(label, "label of an invitation", 100, empty=True)
    expires = None if days is None else now + timedelta(days=days)
    session.add(
        Invitation(
            digest=digest_of(key), role=role, label=label, created=now, expires=expires, uses_left=uses
        )
    )
    return key


def invitations(session: Session) -> list[Invitation]:
    """Return all invitations, the latest first; their keys are not known any more."""
    return list(session.scalars(select(Invitation).order_by(Invitation.id.desc())))


def find_account(session: Session, name: str) -> Account | None:
    """Return the account with a name, if there is one."""
    return session.scalars(select(Account).filter_by(name=name)).one_or_none()


def known_account(session: Session, name: str) -> Account:
    """Return the account with a name.

    Raises:
        NotFoundError: There is none.
    """
    found = find_account(session, name)
    if found is None:
        raise NotFoundError(f"there is no account {name!r}")
    return found


def check_usable(account: Account) -> Account:
    """Return an account that may be used.

    Raises:
        ForbiddenError: The organizers disabled it.
    """
    if account.disabled is not None:
        raise ForbiddenError(f"the account {account.name} is disabled: {account.disabled}")
    return account


def new_token(session: Session, account: Account, label: str, now: datetime) -> str:
    """Make a token, and return it, which is shown once.

    Raises:
        RefusalError: The account has too many.
    """
    label = checked_line(label, "label of a token", 60)
    if len(tokens_of(session, account)) >= MAX_TOKENS:
        raise RefusalError(f"an account has at most {MAX_TOKENS} tokens: revoke one that is no longer used")
    token = new_key(TOKEN)
    session.add(Token(account_id=account.id, digest=digest_of(token), label=label, created=now))
    session.flush()
    return token


def tokens_of(session: Session, account: Account) -> list[Token]:
    """Return the tokens of an account that are not revoked, the oldest first."""
    wanted = select(Token).filter_by(account_id=account.id, revoked=None).order_by(Token.id)
    return list(session.scalars(wanted))


def revoke_token(session: Session, account: Account, token: int, now: datetime) -> None:
    """Revoke a token of an account.

    Raises:
        NotFoundError: The account has no such token.
    """
    found = session.get(Token, token)
    if found is None or found.account_id != account.id or found.revoked is not None:
        raise NotFoundError(f"you have no token {token}")
    found.revoked = now


def revoke_this_token(session: Session, token: str, now: datetime) -> None:
    """Revoke a token that is shown.

    Raises:
        RefusalError: It is nobody's.
    """
    _, found = caller_of_token(session, token)
    found.revoked = now


def caller_of_token(session: Session, token: str) -> tuple[Caller, Token]:
    """Return whose token it is.

    Raises:
        UnknownCallerError: It is nobody's.
        ForbiddenError: The account is disabled.
    """
    wanted = select(Token, Account).join(Account, Account.id == Token.account_id)
    found = session.execute(wanted.filter(Token.digest == digest_of(token), Token.revoked.is_(None)))
    pair = found.one_or_none()
    if pair is None:
        raise UnknownCallerError("this token is unknown or revoked: `wildscav login` gets a new one")
    return Caller(check_usable(pair[1])), pair[0]


def is_use_to_be_noted(token: Token, now: datetime) -> bool:
    """Return whether the last known use of a token was so long ago that it is worth writing this one."""
    return token.used is None or now - token.used > USED_STEP


def open_web_session(session: Session, account: Account, now: datetime) -> tuple[str, str]:
    """Log a browser in, and return the content of its cookie and the token of its forms."""
    session.execute(delete(WebSession).where(WebSession.expires <= now))
    cookie, csrf = new_key(), new_key()
    session.add(
        WebSession(
            digest=digest_of(cookie),
            account_id=account.id,
            csrf=csrf,
            created=now,
            expires=now + SESSION_LASTS,
        )
    )
    return cookie, csrf


def caller_of_cookie(session: Session, cookie: str, now: datetime) -> Caller | None:
    """Return who is logged in with a cookie; None if nobody is."""
    wanted = (
        select(WebSession, Account)
        .join(Account, Account.id == WebSession.account_id)
        .where(WebSession.digest == digest_of(cookie), WebSession.expires > now, Account.disabled.is_(None))
    )
    found = session.execute(wanted).one_or_none()
    return None if found is None else Caller(found[1], found[0].csrf)


def close_web_session(session: Session, cookie: str) -> None:
    """Log a browser out."""
    session.execute(delete(WebSession).filter_by(digest=digest_of(cookie)))


def set_password(session: Session, account: Account, password_hash: str, now: datetime) -> None:
    """Give an account another password; whoever was logged in with the old one is logged out."""
    account.password = password_hash
    session.execute(delete(WebSession).filter_by(account_id=account.id))
    for token in tokens_of(session, account):
        token.revoked = now
