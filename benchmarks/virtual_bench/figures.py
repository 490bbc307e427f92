"""Rates with their binomial intervals, and how they are written."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from scipy.stats import beta, binom


def rate(values: Sequence[bool], confidence: float = 0.99) -> dict[str, Any]:
    """Share in per cent of what is true, of how many, with the Clopper–Pearson interval."""
    hits, count = int(np.sum(values)), len(values)
    tail = (1 - confidence) / 2
    low = 0.0 if hits == 0 else float(beta.ppf(tail, hits, count - hits + 1))
    high = 1.0 if hits == count else float(beta.ppf(1 - tail, hits + 1, count - hits))
    return {
        "percent": round(100 * hits / count, 2),
        "of": count,
        "interval": [round(100 * low, 2), round(100 * high, 2)],
    }


def most(share: float, count: int, confidence: float = 0.99) -> float:
    """The largest percentage in `count` runs that a true rate of `share` explains with this confidence."""
    return 100 * float(binom.ppf(confidence, count, share)) / count


def quantiles(values: Sequence[float]) -> dict[str, float]:
    """Median and the ends of the middle nine tenths."""
    low, middle, high = np.quantile(np.array(values), (0.05, 0.5, 0.95))
    return {"5 %": float(low), "median": float(middle), "95 %": float(high)}
