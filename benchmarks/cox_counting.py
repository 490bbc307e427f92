"""What the full and the basis-reduced realisation need, counted as in the paper and by parts of the work."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from time import process_time

import numpy as np

from benchmarks.command import timed
from identification.arrays import FloatArray
from identification.varying.correlation_analysis import CorrelatedSubMarkov
from identification.varying.ho_kalman import full_realisation, largest_entries, reduced_realisation
from identification.varying.sub_markov import BasisSelection, HankelBlocks, Word, every_word

Parameter = tuple[Word, int, int]


@dataclass(frozen=True, eq=False)
class Known:
    """A source of sub-Markov parameters that are there already."""

    found: HankelBlocks

    def hankel(self, rows: BasisSelection, columns: BasisSelection) -> FloatArray:
        """As found."""
        return self.found.hankel

    def direct(self) -> FloatArray:
        """As found."""
        return self.found.direct

    def blocks(self, rows: BasisSelection, columns: BasisSelection) -> HankelBlocks:
        """As found."""
        return self.found


def countings(source: CorrelatedSubMarkov, bases: int, order: int) -> list[dict[str, object]]:
    """Rows of a table: what is counted, for both, and how many times more the full realisation with ℋ_22 needs."""
    k, n_y, n_u = source.direct().shape
    every_row, every_column = every_word(2, k, n_y), every_word(2, k, n_u)
    at_rows, at_columns = largest_entries(source.hankel(every_row, every_column), bases, bases)
    rows, columns = every_row.subset(at_rows), every_column.subset(at_columns)
    few = list(reduced_parameters(rows, columns, (k, n_y, n_u)))
    many = list(products(every_row, every_column))
    few_known, many_known = Known(source.blocks(rows, columns)), Known(source.blocks(every_row, every_column))
    counted = {
        "parameters estimated, D not counted": (float(len(few)), float(len(many))),
        "ms to correlate them one by one [Cox2018, (8)]": (
            1e3 * seconds(lambda: one_by_one(source, few), 3),
            1e3 * seconds(lambda: one_by_one(source, many), 1),
        ),
        "ms to realise given parameters": (
            1e3 * seconds(lambda: reduced_realisation(few_known, rows, columns, order), 50),
            1e3 * seconds(lambda: full_realisation(many_known, (2, 2), order), 50),
        ),
    }
    return [{"counted": n, "reduced": few, "full": many, "times": many / few} for n, (few, many) in counted.items()]


def products(rows: BasisSelection, columns: BasisSelection, between: Word = ()) -> Iterator[Parameter]:
    """The parameters of all rows with all columns: their word, output and input."""
    for left, i in zip(rows.words, rows.channels, strict=True):
        for right, j in zip(columns.words, columns.channels, strict=True):
            yield left + between + right, i, j


def reduced_parameters(
    rows: BasisSelection, columns: BasisSelection, sizes: tuple[int, int, int]
) -> Iterator[Parameter]:
    """Those of [Cox2018, (20)] for `sizes` (1 + n_ψ, n_y, n_u)."""
    k, n_y, n_u = sizes
    for between in ((), *((letter,) for letter in range(k))):
        yield from products(rows, columns, between)
    yield from products(rows, every_word(1, k, n_u))
    yield from products(every_word(1, k, n_y), columns)


def one_by_one(source: CorrelatedSubMarkov, parameters: list[Parameter]) -> FloatArray:
    """Each parameter by a correlation of its own."""
    psi, u, y = source.excitation.psi_dual, source.excitation.input_dual, np.ascontiguousarray(source.output.T)
    samples, found = y.shape[1], np.empty(len(parameters))
    for place, (word, i, j) in enumerate(parameters):
        last = len(word) - 1
        product = y[i, last:] * u[j, : samples - last]
        for delay, letter in enumerate(word):
            product *= psi[letter, last - delay : samples - delay]
        found[place] = product.sum() / (samples - last)
    return found


def seconds(call: Callable[[], object], repeats: int) -> float:
    """The best processor time."""
    return min(timed(call, process_time) for _ in range(repeats))
