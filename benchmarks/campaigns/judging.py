"""An answer held against the truth: right, honest, wrong or confidently wrong; and the error on what was held out."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

HARMLESS = 1.1


def judged(said: Mapping[str, Any], truth: Mapping[str, Any]) -> str:
    """Right: an accepted kind stands first, at its place, its amplitude within three deviations or a tenth, alone; or
    nothing where nothing is right. Honest: no judgement, or not in the library, without another name."""
    kinds, ended, confident = said["announced"], said["verdict"], bool(said["confident"])
    accepted = [[one] if isinstance(one, str) else one for one in truth.get("accept", ())]
    met = next((one for one in accepted if sorted(kinds[: len(one)]) == sorted(one)), None)
    if ended == "nothingMissing":
        return "right" if truth.get("nothing_is_right") else "confidently wrong"
    if met and ended in ("explained", "partlyExplained") and _agrees(said["added"], truth, met, accepted):
        return "right"
    silent = not kinds or (met is not None and ended == "notInTheLibrary")
    if ended in ("cannotBeJudged", "notInTheLibrary") and silent and not confident:
        return "honest"
    return "confidently wrong" if confident or (ended == "explained" and not met) else "wrong"


def _agrees(added: list[dict[str, Any]], truth: Mapping[str, Any], met: list[str], accepted: list[list[str]]) -> bool:
    if any(all(one["kind"] not in kinds for kinds in accepted) for one in added):
        return False
    own = [one for one in added if one["kind"] in met]
    amplitude, at = truth.get("amplitude"), truth.get("at")
    if own and at is not None and own[0]["at"] is not None and abs(own[0]["at"] - at) > 1e-6:
        return False
    if own and amplitude is not None and own[0]["amplitude"] is not None:
        margin = max(3 * (own[0]["standardError"] or 0.0), 0.1 * abs(amplitude))
        return bool(abs(own[0]["amplitude"] - amplitude) <= margin)
    return True


def held_out_errors(said: Mapping[str, Any], results: Path, answers: Path) -> tuple[float | None, float | None]:
    """‖y − ŷ‖ / ‖y − ȳ‖ over what was held out, before and after; the first tenth of a record is left out."""
    if not said.get("predictions"):
        return None, None
    with np.load(answers / f"{said['case']}.npz") as truth, np.load(results.parent / said["predictions"]) as predicted:
        return _error(truth, predicted, "before"), _error(truth, predicted, "after")


def _error(truth: Any, predicted: Any, when: str) -> float | None:
    off = size = 0.0
    for name in truth:
        key = f"{when}_{name.rsplit('_', 1)[0]}"
        if key not in predicted:
            return None
        y, skip = truth[name], len(truth[name]) // 10 if name.endswith("_y") else 0
        mean = y.mean() if skip else 0.0
        off += float(np.sum(abs(y - predicted[key])[skip:] ** 2))
        size += float(np.sum(abs(y - mean)[skip:] ** 2))
    return float(np.sqrt(off / size)) if size else None
