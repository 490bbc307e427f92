"""Small rooms: files of 150 lines in the middle, 400 at most; functions of 10 in the middle, nine in ten up to 35."""

from statistics import median, quantiles

import pytest

from tests.support.sources import PACKAGES, Function, Source, all_sources, sources

NEARLY_EMPTY = 12  # an __init__.py says nothing about the size of files


def length(function: Function) -> int:
    return (function.end_lineno or function.lineno) - function.lineno + 1


def function_lengths(some: tuple[Source, ...]) -> list[int]:
    return [length(function) for source in some for function in source.functions()]


def test_no_file_is_long() -> None:
    assert {str(source.path): source.lines for source in all_sources() if source.lines > 400} == {}


@pytest.mark.parametrize("package", PACKAGES)
def test_files_are_small_in_the_middle(package: str) -> None:
    assert median(source.lines for source in sources(package) if source.lines > NEARLY_EMPTY) <= 150


def test_functions_are_small() -> None:
    lengths = function_lengths(all_sources())
    longest = sorted((length(f), f"{s.path}:{f.lineno} {f.name}") for s in all_sources() for f in s.functions())[-10:]
    assert median(lengths) <= 10, longest
    assert quantiles(lengths, n=10, method="inclusive")[-1] <= 35, longest
