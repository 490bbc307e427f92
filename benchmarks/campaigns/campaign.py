"""What a campaign is: what a user would say, what was measured, and what only the judge knows."""

import json
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from identification.arrays import FloatArray


@dataclass(frozen=True)
class Truth:
    """What is hidden: kinds that count as right (a tuple: in any order), its amplitude, the point logged wrongly."""

    accept: tuple[str | tuple[str, ...], ...] = ()
    nothing_is_right: bool = False
    amplitude: float | None = None
    at: float | None = None


@dataclass
class Campaign:
    """An entry of the index with its arrays, the outputs held out, and the truth."""

    entry: dict[str, Any]
    truth: Truth
    arrays: dict[str, np.ndarray] = field(default_factory=dict)
    answers: dict[str, np.ndarray] = field(default_factory=dict)
    _counts: dict[str, int] = field(default_factory=dict)

    def record(
        self, p: float, u: FloatArray, y: FloatArray, sample_time: float, period: int | None, part: str, **more: Any
    ) -> None:
        """Adds a record of the part "fitted" or "held_out" with its input as measured, one period or all samples."""
        name = self._next(part)
        said = {"part": part, "operating_point": [float(p)], "sample_time": sample_time, "period": period}
        once = period is not None and len(u) == period
        self.entry["experiments"].append({**said, "input_is_one_period": once, "samples": len(y), **more})
        self.arrays[f"{name}_u"] = u
        (self.arrays if part == "fitted" else self.answers)[f"{name}_y"] = y

    def response(self, p: float, omega: FloatArray, response: FloatArray, part: str) -> None:
        """Adds a frequency response without its variance."""
        name = self._next(part)
        self.entry["experiments"].append({"part": part, "operating_point": [float(p)]})
        self.arrays[f"{name}_omega"] = omega
        (self.arrays if part == "fitted" else self.answers)[f"{name}_response"] = response

    def _next(self, part: str) -> str:
        number = self._counts.get(part, 0)
        self._counts[part] = number + 1
        return f"{part}{number}"


def campaign(case: str, truth: Truth, said: dict[str, Any]) -> Campaign:
    """A campaign without experiments yet; what `said` leaves out is band limited and ran without feedback."""
    known = {"case": case, "input_between_samples": "band_limited", "closed_loop": False}
    return Campaign({**known, **said, "experiments": []}, truth)


def write(folder: Path, campaigns: Sequence[Campaign]) -> None:
    """index.json and NAME.npz for the one who answers; truth.json and answers/NAME.npz for the judge."""
    (folder / "answers").mkdir(parents=True, exist_ok=True)
    for one in campaigns:
        np.savez(folder / f"{one.entry['case']}.npz", **one.arrays)
        np.savez(folder / "answers" / f"{one.entry['case']}.npz", **one.answers)
    (folder / "index.json").write_text(json.dumps([one.entry for one in campaigns], indent=1))
    truths = {one.entry["case"]: {k: v for k, v in vars(one.truth).items() if v} for one in campaigns}
    (folder / "truth.json").write_text(json.dumps(truths, indent=1))
