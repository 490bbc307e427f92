"""Figures made of characters."""

from collections.abc import Sequence

import numpy as np

from app.report.figures.misfit_map import MapRow
from identification.arrays import FloatArray

BLOCKS = "▁▂▃▄▅▆▇█"
PARTS = " ▏▎▍▌▋▊▉█"
SHADES = " ░▒▓█"
LEVELS = (1.5, 2.5, 5.0, 10.0)


def sparkline(values: FloatArray | Sequence[float]) -> str:
    """One character a value, its height in proportion to the largest."""
    numbers = np.maximum(np.asarray(values, dtype=np.float64), 0.0)
    top = float(numbers.max(initial=0.0))
    if top == 0:
        return BLOCKS[0] * len(numbers)
    return "".join(BLOCKS[min(int(len(BLOCKS) * value / top), len(BLOCKS) - 1)] for value in numbers)


def bar(share: float, width: int) -> str:
    """A bar of a share of the width, in eighths of a character; it never leaves the width."""
    eighths = round(8 * width * min(max(share, 0.0), 1.0))
    return ("█" * (eighths // 8) + PARTS[eighths % 8]).strip()


def shaded(row: MapRow, low: float, high: float, width: int) -> str:
    """Residuals over the logarithm of frequency, the darker the larger; a blank is noise."""
    edges = np.geomspace(low, high, width + 1)
    levels = np.nan_to_num(np.fmax(row.cells(True, edges), row.cells(False, edges)))
    return "".join(SHADES[int(np.searchsorted(LEVELS, level))] for level in levels)
