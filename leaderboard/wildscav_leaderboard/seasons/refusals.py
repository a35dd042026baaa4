"""Refusals: what a season does not do, why, and the HTTP status that says so. One handler answers all."""

from http import HTTPStatus

from wildscav.errors import UserError


class RefusalError(UserError):
    """What was asked for is not done. The message is one line that says why, and what is allowed."""

    status = HTTPStatus.CONFLICT


class InvalidError(RefusalError):
    """What was sent is not valid."""

    status = HTTPStatus.UNPROCESSABLE_ENTITY


class NotFoundError(RefusalError):
    """There is no such thing, or not for whoever asks."""

    status = HTTPStatus.NOT_FOUND


class UnknownCallerError(RefusalError):
    """Whoever asks is not logged in, or gave a wrong name, password or token."""

    status = HTTPStatus.UNAUTHORIZED


class ForbiddenError(RefusalError):
    """Whoever asks may not do this."""

    status = HTTPStatus.FORBIDDEN


class TooMuchError(RefusalError):
    """A quota or a rate limit is used up."""

    status = HTTPStatus.TOO_MANY_REQUESTS


class UnavailableError(RefusalError):
    """Something went wrong here; nobody who asks is to blame."""

    status = HTTPStatus.SERVICE_UNAVAILABLE


class TooLargeError(RefusalError):
    """What was sent is too large."""

    status = HTTPStatus.REQUEST_ENTITY_TOO_LARGE
