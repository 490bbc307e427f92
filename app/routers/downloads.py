"""Files as answers."""

from typing import Any

from fastapi import Response

from app.files.stored import MEDIA_TYPES

BINARY = {"schema": {"type": "string", "format": "binary"}}


def file_answer(*formats: str) -> dict[int | str, dict[str, Any]]:
    """The description of an answer that is a file in one of the formats; generated clients read it as the first."""
    media_types = sorted({MEDIA_TYPES[name] for name in formats})
    return {200: {"description": "The file", "content": dict.fromkeys(media_types, BINARY)}}


def file_response(content: bytes, stem: str, file_format: str) -> Response:
    """A file to be saved under the name `stem.format`."""
    disposition = f'attachment; filename="{stem}.{file_format}"'
    headers = {"Content-Disposition": disposition, "X-Content-Type-Options": "nosniff"}
    return Response(content, media_type=MEDIA_TYPES[file_format], headers=headers)
