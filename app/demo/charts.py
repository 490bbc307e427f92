"""Figures made of characters."""

from collections.abc import Sequence

import numpy as np

from identification.arrays import FloatArray

BLOCKS = "▁▂▃▄▅▆▇█"
PARTS = " ▏▎▍▌▋▊▉█"


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
