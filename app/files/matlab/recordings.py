"""Structures that programs save measurements in: dSPACE recorders, Simulink signals, iddata, idfrd and frd."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.files.contents import Column, Table

Tree = Mapping[str, Any]
_TIME_UNITS = {"seconds": "s", "milliseconds": "ms", "microseconds": "us", "minutes": "min", "hours": "h"}


def understood(tree: Tree) -> list[Table] | None:
    """The tables of a structure of a known form; None when it has none of them."""
    for reading in (_recorder, _signals_with_time, _time_data, _frequency_data):
        found = reading(tree)
        if found is not None:
            return found
    return None


def _recorder(tree: Tree) -> list[Table] | None:
    """dSPACE: X with the time axes, Y(k) with Name and Data of each channel."""
    axes, channels = _list(tree.get("X")), _list(tree.get("Y"))
    channels = [one for one in channels if _array(one.get("Data")) is not None]
    if not channels:
        return None
    columns = [
        Column(str(one.get("Name") or "time") if i else "time", _vector(one["Data"]), _text(one.get("Unit")))
        for i, one in enumerate(axes)
        if _array(one.get("Data")) is not None
    ]
    columns += [
        Column(_last(str(one.get("Name") or f"Y({i + 1})")), _vector(one["Data"]), _text(one.get("Unit")))
        for i, one in enumerate(channels)
    ]
    return [Table(_distinct(columns))]


def _signals_with_time(tree: Tree) -> list[Table] | None:
    """Simulink: time, and signals(k) with values and label; timeseries: Time, Data and Name."""
    signals, time = _list(tree.get("signals")), _array(tree.get("time"))
    if signals and time is not None and all(_array(one.get("values")) is not None for one in signals):
        named = [(str(one.get("label") or f"signals({i + 1})"), one["values"]) for i, one in enumerate(signals)]
        return [Table(_distinct([Column("time", time), *(Column(_last(name), one) for name, one in named)]))]
    return None


def _time_data(tree: Tree) -> list[Table] | None:
    """iddata saved as a structure; several experiments in cells are tables of their own."""
    outputs = tree.get("OutputData")
    if outputs is None or "InputData" not in tree:
        return None
    inputs, steps = tree["InputData"], tree.get("Ts")
    several = isinstance(outputs, list) and len(outputs) > 1
    made = []
    for i, output in enumerate(_cells(outputs)):
        columns = [Column("output", output)] if _array(output) is not None else []
        given = _at(inputs, i)
        columns += [Column("input", given)] if _array(given) is not None else []
        step, instants = _array(_at(steps, i)), _array(_at(tree.get("SamplingInstants"), i))
        unit = _TIME_UNITS.get(_text(tree.get("TimeUnit")), _text(tree.get("TimeUnit")))
        if step is not None and np.all(step > 0):
            columns.append(Column("sampleTime", step, unit))
        elif instants is not None:
            columns.append(Column("time", instants, unit))
        made.append(Table(tuple(columns), f"experiment({i + 1})" if several else ""))
    return made


def _frequency_data(tree: Tree) -> list[Table] | None:
    """idfrd and frd saved as a structure: ResponseData (n_y × n_u × F), Frequency and its unit, Ts, CovarianceData."""
    response, frequency = _array(tree.get("ResponseData")), _array(tree.get("Frequency"))
    if response is None or frequency is None:
        return None
    unit = _text(tree.get("FrequencyUnit") or tree.get("Units")).replace("TimeUnit", "s").replace("seconds", "s")
    columns = [Column("frequency", frequency, unit or "rad/s"), Column("response", response)]
    covariance = _array(tree.get("CovarianceData"))
    if covariance is not None and covariance.shape[-2:] == (2, 2):
        columns.append(Column("variance", np.trace(covariance, axis1=-2, axis2=-1)))
    step = _array(tree.get("Ts"))
    if step is not None and np.all(step > 0):
        columns.append(Column("sampleTime", step, _TIME_UNITS.get(_text(tree.get("TimeUnit")), "s")))
    return [Table(tuple(columns))]


def _distinct(columns: Sequence[Column]) -> tuple[Column, ...]:
    """Columns with a number behind names that come twice."""
    names = [column.name for column in columns]
    return tuple(
        Column(f"{one.name} {i + 1}" if names.count(one.name) > 1 else one.name, one.values, one.unit)
        for i, one in enumerate(columns)
    )


def _list(value: Any) -> list[Tree]:
    if isinstance(value, Mapping):
        return [value]
    return [one for one in value if isinstance(one, Mapping)] if isinstance(value, list) else []


def _cells(value: Any) -> list[Any]:
    return value if isinstance(value, list) else [value]


def _at(value: Any, index: int) -> Any:
    cells = _cells(value)
    return cells[index] if index < len(cells) else (cells[0] if len(cells) == 1 else None)


def _array(value: Any) -> NDArray[Any] | None:
    return value if isinstance(value, np.ndarray) and value.size and value.dtype.kind in "biufc" else None


def _vector(value: NDArray[Any]) -> NDArray[Any]:
    return np.asarray(value).ravel() if value.size == max(value.shape, default=1) else value


def _text(value: Any) -> str:
    value = value[0] if isinstance(value, list) and value else value
    return value.strip() if isinstance(value, str) else ""


def _last(name: str) -> str:
    """The last step of a path such as Model Root/Plant/speed [rpm] or "platform()://…"/u; units with a stroke stay."""
    steps = name.strip().strip('"').replace('"', "").split("/")
    return steps[-1] if len(steps) > 2 else name.strip().strip('"')
