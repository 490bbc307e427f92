"""Bytes to text: UTF-8, UTF-16 and UTF-32 with their marks or without, else Latin-1 as Windows writes it."""

import codecs

from app.files.contents import FileError

_MARKS = (
    (codecs.BOM_UTF32_LE, "utf-32"),
    (codecs.BOM_UTF32_BE, "utf-32"),
    (codecs.BOM_UTF8, "utf-8-sig"),
    (codecs.BOM_UTF16_LE, "utf-16"),
    (codecs.BOM_UTF16_BE, "utf-16"),
)
_PRINTABLE = {"\t", "\n", "\r", "\f", "\v", "\x1a", "\x85"}


def decoded(content: bytes) -> str:
    """The text of a file; raises FileError when it is none."""
    for encoding in (*(name for mark, name in _MARKS if content.startswith(mark)), *_likely(content)):
        try:
            text = content.decode(encoding)
        except UnicodeDecodeError:
            continue
        if _is_text(text):
            return text
    raise FileError("the file is not a text, though its name says so")


def head_text(content: bytes, size: int = 4096) -> str:
    """The beginning of a text, "" where it is none."""
    try:
        return decoded(content[: size - size % 4])
    except FileError:
        return content[:size].decode("latin-1") if b"\0" not in content[:size] else ""


def _likely(content: bytes) -> tuple[str, ...]:
    head = content[:2000]
    if b"\0" in head:
        even, odd = head[::2].count(0), head[1::2].count(0)
        return ("utf-16-le",) if odd > even else ("utf-16-be",)
    return ("utf-8", "cp1252", "latin-1")


def _is_text(text: str) -> bool:
    head = text[:2000]
    return all(character.isprintable() or character in _PRINTABLE or character == "\ufeff" for character in head)
