"""Errors that the service answers with, all as one kind of document: a problem of RFC 9457."""

import json
from collections.abc import Mapping, Sequence
from http import HTTPStatus
from typing import ClassVar

from fastapi import Response

from app.schemas.common import FieldProblem, Problem

MEDIA_TYPE = "application/problem+json"


class ProblemError(Exception):
    """An answer that is no success. Raise one of the subclasses from a router or a service."""

    status: ClassVar[int] = 500
    slug: ClassVar[str] = "internal-error"
    title: ClassVar[str] = "Internal error"

    def __init__(
        self, detail: str, errors: Sequence[FieldProblem] = (), headers: Mapping[str, str] | None = None
    ) -> None:
        super().__init__(detail)
        self.detail = detail
        self.errors = list(errors)
        self.headers = dict(headers or {})

    def problem(self, instance: str | None = None) -> Problem:
        """The document of this error."""
        return Problem(
            type=problem_type(self.slug),
            title=self.title,
            status=self.status,
            detail=self.detail,
            instance=instance,
            errors=self.errors,
        )


class BadRequestError(ProblemError):
    """The request cannot be read at all: malformed JSON, broken multipart, an unknown Host."""

    status, slug, title = 400, "bad-request", "Bad request"


class UnauthorizedError(ProblemError):
    """The bearer token is missing or wrong."""

    status, slug, title = 401, "unauthorized", "Authentication required"


class ForbiddenError(ProblemError):
    """The server does not answer requests of this origin."""

    status, slug, title = 403, "forbidden", "Forbidden"


class NotFoundError(ProblemError):
    """There is no such resource."""

    status, slug, title = 404, "not-found", "Not found"


class ConflictError(ProblemError):
    """The request does not fit the present state, or its Idempotency-Key was used for another request."""

    status, slug, title = 409, "conflict", "Conflict"


class ContentTooLargeError(ProblemError):
    """The request body, or the arrays in it, exceed the limit."""

    status, slug, title = 413, "content-too-large", "Content too large"


class UnsupportedMediaTypeError(ProblemError):
    """The content type of the body is not the one that the operation reads."""

    status, slug, title = 415, "unsupported-media-type", "Unsupported media type"


class UnprocessableError(ProblemError):
    """The request can be read but not be answered as it stands; `errors` point to the bad fields."""

    status, slug, title = 422, "invalid-request", "Invalid request"

    @classmethod
    def at(cls, pointer: str, detail: str, location: str = "body") -> "UnprocessableError":
        """One bad field, e.g. `UnprocessableError.at("/operatingPoint", "has 2 values, the plant has 1 variable")`."""
        return cls(detail, [FieldProblem(pointer=pointer, detail=detail, location=location)])


class TooSlowError(ProblemError):
    """The body of the request did not come in time."""

    status, slug, title = 408, "request-timeout", "Request timeout"


class UnavailableError(ProblemError):
    """The service cannot do this now; the same request may succeed later."""

    status, slug, title = 503, "service-unavailable", "Service unavailable"


class NoRoomError(ProblemError):
    """The disk is full; nothing of the request was kept."""

    status, slug, title = 507, "insufficient-storage", "Insufficient storage"


class TooManyRequestsError(ProblemError):
    """Too many wrong tokens came from one address."""

    status, slug, title = 429, "too-many-requests", "Too many requests"


class InternalError(ProblemError):
    """A fault of the service; the log has the cause, the answer has not."""


def problem_type(slug: str) -> str:
    """The URI that names a kind of problem."""
    return f"urn:lpv-oed:problem:{slug}"


def problem_of_status(status: int, detail: str) -> Problem:
    """A problem for a bare HTTP status, such as the 405 of the router."""
    phrase = HTTPStatus(status).phrase
    slug = phrase.lower().replace(" ", "-").replace("'", "")
    return Problem(type=problem_type(slug), title=phrase.capitalize(), status=status, detail=detail or phrase)


def problem_response(problem: Problem, headers: Mapping[str, str] | None = None) -> Response:
    """The HTTP answer; escapes what UTF-8 cannot carry, so that no bad input can break it."""
    body = json.dumps(problem.model_dump(by_alias=True, exclude_none=True), ensure_ascii=True)
    return Response(body, status_code=problem.status, headers=dict(headers or {}), media_type=MEDIA_TYPE)
