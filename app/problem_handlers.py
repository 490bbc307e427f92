"""Turns everything that can go wrong in a request into a problem document."""

from collections.abc import Mapping, Sequence
from typing import Any

from fastapi import FastAPI, Request, Response, params
from fastapi.exceptions import RequestValidationError
from starlette.exceptions import HTTPException
from starlette.routing import Match

from app.errors import (
    BadRequestError,
    InternalError,
    NoRoomError,
    ProblemError,
    UnavailableError,
    UnprocessableError,
    UnsupportedMediaTypeError,
    problem_of_status,
    problem_response,
)
from app.json_pointer import body_pointer, field_pointer, pointer
from app.schemas.common import FieldProblem
from app.store.arrays import ArraysTooLargeError
from app.store.faults import fault_of, is_full
from identification.errors import MisuseError

NO_ROOM = (
    "the disk of the server is full, and nothing of this request was kept; free some room below LPV_OED_DATA_DIR"
    " (and the folder for temporary files), then send the same request again"
)
DAMAGED = "the database is damaged; stop the server and restore a backup with lpv-oed restore"
LATER = {"Retry-After": "30"}
METHODS = ("GET", "HEAD", "POST", "PUT", "PATCH", "DELETE")


def add_problem_handlers(application: FastAPI) -> None:
    """Register a handler for every kind of exception."""
    application.add_exception_handler(ProblemError, _on_problem_error)
    application.add_exception_handler(RequestValidationError, _on_validation_error)
    application.add_exception_handler(HTTPException, _on_http_exception)
    application.add_exception_handler(MisuseError, _on_misuse)
    application.add_exception_handler(ArraysTooLargeError, _on_arrays_too_large)


def answer(error: ProblemError, path: str) -> Response:
    """The HTTP answer of an error."""
    return problem_response(error.problem(path), error.headers)


def answer_to_fault(error: Exception, path: str) -> Response:
    """The HTTP answer to what no handler knows: the disk, the database, or a fault of the service."""
    return answer(_of_storage(error) or InternalError("a fault of the service; its log has the cause"), path)


def _of_storage(error: Exception) -> ProblemError | None:
    match fault_of(error):
        case "full":
            return NoRoomError(NO_ROOM, headers=LATER)
        case "unreachable":
            return UnavailableError("the database cannot be reached now; send the same request again", headers=LATER)
        case "damaged":
            return UnavailableError(DAMAGED)
    return None


def unreadable(cause: BaseException) -> ProblemError:
    """Why the body of a request could not be read."""
    if is_full(cause):
        return NoRoomError(NO_ROOM, headers=LATER)
    match cause:
        case UnicodeDecodeError():
            return BadRequestError(f"the body is no JSON in UTF-8: byte {cause.start} cannot be decoded")
        case RecursionError():
            return BadRequestError("the body is nested too deeply; put fewer lists and objects into each other")
        case ValueError() if "digits" in str(cause):
            return BadRequestError("the body has an integer of too many digits; write it as a number with exponent")
    return BadRequestError(f"the body cannot be read: {cause}" if str(cause) else "the body cannot be read")


async def _on_problem_error(request: Request, error: Exception) -> Response:
    assert isinstance(error, ProblemError)
    return answer(error, request.url.path)


async def _on_http_exception(request: Request, error: Exception) -> Response:
    assert isinstance(error, HTTPException)
    headers = {"Allow": ", ".join(_allowed_methods(request))} if error.status_code == 405 else error.headers
    if error.status_code == 400 and error.__cause__ is not None:
        return answer(unreadable(error.__cause__), request.url.path)
    return problem_response(problem_of_status(error.status_code, str(error.detail)), headers)


async def _on_misuse(request: Request, error: Exception) -> Response:
    assert isinstance(error, MisuseError)
    fields = [FieldProblem(pointer=field_pointer(error.field), detail=str(error))] if error.field else []
    return answer(UnprocessableError(str(error), fields), request.url.path)


async def _on_arrays_too_large(request: Request, error: Exception) -> Response:
    return answer(UnprocessableError(str(error)), request.url.path)


async def _on_validation_error(request: Request, error: Exception) -> Response:
    assert isinstance(error, RequestValidationError)
    return answer(_error_of_validation(request, error), request.url.path)


def _error_of_validation(request: Request, error: RequestValidationError) -> ProblemError:
    failures = error.errors()
    for failure in failures:
        if failure["type"] == "json_invalid":
            reason, position = failure["ctx"]["error"], failure["loc"][-1]
            return BadRequestError(f"the body is no JSON: {reason} at character {position}")
    if error.body is not None and any(failure["loc"][0] == "body" for failure in failures):
        expected = _expected_media_type(request)
        if expected is not None and not _has_media_type(request, expected):
            return UnsupportedMediaTypeError(f"the body must be sent as {expected}")
    fields = [_field_problem(failure, error.body) for failure in failures]
    return UnprocessableError(_summary(fields), fields)


def _field_problem(failure: Mapping[str, Any], body: Any) -> FieldProblem:
    location, *steps = failure["loc"]
    if location == "body":
        where = body_pointer(steps, _readable(body), missing=failure["type"] == "missing")
    else:
        where = pointer([str(step) for step in steps[:1]])
    return FieldProblem(pointer=where, detail=failure["msg"], location=str(location))


def _readable(body: Any) -> Any:
    """The body as plain data; the fields of a form are its first level."""
    return dict(body) if isinstance(body, Mapping) else body


def _summary(fields: Sequence[FieldProblem]) -> str:
    first = fields[0]
    more = f", and {len(fields) - 1} more" if len(fields) > 1 else ""
    return f"{first.pointer or 'the body'}: {first.detail}{more}"


def _allowed_methods(request: Request) -> list[str]:
    """All methods of a path; the router itself names those of the first route only."""
    scope = {"type": "http", "path": request.scope["path"], "root_path": "", "headers": []}
    routes = request.app.routes
    return [m for m in METHODS if any(route.matches(scope | {"method": m})[0] is Match.FULL for route in routes)]


def _expected_media_type(request: Request) -> str | None:
    body_field = getattr(request.scope.get("route"), "body_field", None)
    if body_field is None:
        return None
    return "multipart/form-data" if isinstance(body_field.field_info, params.Form) else "application/json"


def _has_media_type(request: Request, expected: str) -> bool:
    given = request.headers.get("content-type", "").partition(";")[0].strip().lower()
    if expected == "application/json":
        return given == expected or (given.startswith("application/") and given.endswith("+json"))
    return given in (expected, "application/x-www-form-urlencoded")
