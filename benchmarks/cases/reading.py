"""Cases as a user would state them: an index of what is known, and arrays of what was measured."""

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, get_args

import numpy as np

from identification.arrays import FloatArray
from identification.bases.polynomial import Polynomial
from identification.channels import Channel, Channels, Quantity
from identification.models.model import Model
from identification.models.rational import RationalStructure
from identification.scheduling import ParameterDependence, ProductBasis, SchedulingVariable
from identification.signals import FrequencyResponse, Hold, Measurement, TimeRecord

SYNONYMS: dict[str, Quantity] = {
    "displacement": "position",
    "distance": "position",
    "speed": "velocity",
    "rotation": "angle",
    "rotational speed": "angular velocity",
    "angular speed": "angular velocity",
    "moment": "torque",
    "volume flow": "flow",
    "flow rate": "flow",
    "heat flow rate": "heat flow",
    "heating power": "heat flow",
}
ANGULAR: dict[Quantity, Quantity] = {
    "position": "angle",
    "velocity": "angular velocity",
    "acceleration": "angular acceleration",
}
HOLDS: dict[str, Hold] = {"zero_order_hold": "zero", "first_order_hold": "first", "band_limited": "band"}


@dataclass(frozen=True)
class HeldOut:
    """An experiment whose output is to be predicted: its input as it was stored, or its frequencies."""

    name: str
    point: tuple[float, ...]
    logged: Mapping[str, float]
    input: FloatArray | None = None
    sample_time: float = 1.0
    period: int | None = None
    samples: int = 0
    hold: Hold | None = None
    frequencies: FloatArray | None = None


@dataclass(frozen=True)
class Case:
    """One campaign: the model to begin with, what was measured, and what is to be predicted."""

    name: str
    model: Model
    fitted: tuple[Measurement, ...]
    logged: tuple[Mapping[str, float], ...]
    held_out: tuple[HeldOut, ...]


def stated(folder: Path, only: Sequence[str] = ()) -> list[dict[str, Any]]:
    """The entries of index.json, all or those of the given names in the order of the index."""
    entries: list[dict[str, Any]] = json.loads((folder / "index.json").read_text(encoding="utf-8"))
    unknown = set(only) - {one["case"] for one in entries}
    if unknown:
        raise SystemExit(f"{folder / 'index.json'} has no case {', '.join(sorted(unknown))}")
    return [one for one in entries if not only or one["case"] in only]


def read(entry: Mapping[str, Any], folder: Path) -> Case:
    """The case of one entry of the index, with the arrays of its npz file."""
    channels = Channels(channel(entry["input"]), channel(entry["output"]))
    hold = HOLDS.get(entry.get("input_between_samples") or "")
    feedback = bool(entry.get("closed_loop"))
    fitted, held_out = [], []
    with np.load(folder / f"{entry['case']}.npz") as arrays:
        for name, one in _numbered(entry["experiments"]):
            if one["part"] == "fitted":
                fitted.append((_measurement(name, one, arrays, channels, hold, feedback), _logged(one)))
            else:
                held_out.append(_held_out(name, one, arrays, hold))
    return Case(entry["case"], _model(entry), *zip(*fitted, strict=True), tuple(held_out))


def channel(said: Mapping[str, Any]) -> Channel:
    """A channel from words as people write them; a motion measured in an angle is a rotation."""
    word = " ".join(str(said.get("quantity") or "").replace("_", " ").lower().split())
    known = SYNONYMS.get(word) or next((q for q in get_args(Quantity) if q == word), None)
    unit = str(said.get("unit") or "")
    if known in ANGULAR and unit.startswith(("rad", "deg", "°", "rpm", "1/min", "rev")):
        known = ANGULAR[known]
    return Channel(str(said.get("name") or word), known, unit)


def _numbered(experiments: Sequence[Mapping[str, Any]]) -> Iterator[tuple[str, Mapping[str, Any]]]:
    """Each experiment with the name of its arrays: its part and its number within that."""
    counts: dict[str, int] = {}
    for one in experiments:
        number = counts.get(one["part"], 0)
        counts[one["part"]] = number + 1
        yield f"{one['part']}{number}", one


def _point(one: Mapping[str, Any]) -> tuple[float, ...]:
    return tuple(map(float, one["operating_point"]))


def _logged(one: Mapping[str, Any]) -> dict[str, float]:
    return {name: float(value) for name, value in (one.get("logged") or {}).items()}


def _measurement(
    name: str, one: Mapping[str, Any], arrays: Any, channels: Channels, hold: Hold | None, feedback: bool
) -> Measurement:
    if f"{name}_omega" in arrays:
        variance = arrays.get(f"{name}_variance")
        omega, response = arrays[f"{name}_omega"], arrays[f"{name}_response"]
        return FrequencyResponse(omega, response, _point(one), None, variance, channels=channels)
    output, period = arrays[f"{name}_y"], one.get("period")
    reference = arrays.get(f"{name}_r") if feedback else None
    return TimeRecord(
        repeated(arrays[f"{name}_u"], len(output)),
        output,
        float(one["sample_time"]),
        _point(one),
        None if period is None else int(period),
        channels,
        hold,
        feedback,
        None if reference is None else repeated(reference, len(output)),
    )


def _held_out(name: str, one: Mapping[str, Any], arrays: Any, hold: Hold | None) -> HeldOut:
    if f"{name}_omega" in arrays:
        return HeldOut(name, _point(one), _logged(one), frequencies=arrays[f"{name}_omega"])
    period = one.get("period")
    return HeldOut(
        name,
        _point(one),
        _logged(one),
        arrays[f"{name}_u"],
        float(one["sample_time"]),
        None if period is None else int(period),
        int(one["samples"]),
        hold,
    )


def repeated(signal: FloatArray, samples: int) -> FloatArray:
    """A signal (L,) repeated, (samples,)."""
    return np.asarray(np.resize(signal, samples))


def _model(entry: Mapping[str, Any]) -> Model:
    structure = RationalStructure(**entry["structure"])
    said = entry["scheduling"]
    every = [said] if isinstance(said, Mapping) else said
    variables = tuple(SchedulingVariable(v["name"], v.get("unit") or "", v["minimum"], v["maximum"]) for v in every)
    bases = tuple(_basis(degrees, len(variables)) for degrees in entry["polynomial_degrees"])
    theta = np.array(entry["theta_start"], dtype=np.float64)
    return Model(structure, ParameterDependence(variables, bases), theta, np.eye(len(theta)), 1.0)


def _basis(degrees: int | Sequence[int], variables: int) -> ProductBasis:
    each = [degrees] * variables if isinstance(degrees, int) else degrees
    return ProductBasis(tuple(Polynomial(degree) for degree in each))
