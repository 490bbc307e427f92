"""A motor with a flexible coupling: python -m benchmarks.motor_bench FOLDER --page motor.html.

FOLDER holds MultisineTypeA.mat and MultisineTypeB.mat. From a rigid body the diagnosis is asked for what is missing;
errors are ‖G − Ĝ‖/‖G‖ over the lines. In type B, whose multisine leaves lines out, the lines that
were not excited show the nonlinear part: what the output has there beyond the answer to the measured current, as the
current that would cause it.
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from app.report.style import colour, new_figure
from benchmarks.command import command_line, write_json
from identification.arrays import ComplexArray, IntArray
from identification.bases.polynomial import Polynomial
from identification.comparison.gather import gather
from identification.diagnosis.staircase import Step, staircase
from identification.effects.library import library
from identification.extension.response import linear_response
from identification.models.model import Model
from identification.models.rational import RationalStructure
from identification.scheduling import ParameterDependence, ProductBasis, SchedulingVariable
from identification.signals import FrequencyResponse

PERIOD, DROPPED, SAMPLE_RATE = 2500, 2, 2500.0
LOWEST, HIGHEST = 11, 250
STILL = SchedulingVariable("operating point", "1", -1.0, 1.0)


@dataclass(frozen=True, eq=False)
class Spectra:
    """Lines of one hertz each of the steady periods, (periods, lines): current in A, angle in rad; what was excited."""

    current: ComplexArray
    angle: ComplexArray
    excited: IntArray

    def response(self) -> FrequencyResponse:
        """Angle over current at the excited lines."""
        k = self.excited
        measured = self.angle.mean(axis=0)[k] / self.current.mean(axis=0)[k]
        return FrequencyResponse(2 * np.pi * k * SAMPLE_RATE / PERIOD, measured, (0.0,))


def read(folder: Path, kind: str) -> Spectra:
    """The spectra of type A or B, the first two periods dropped."""
    from scipy.io import loadmat

    data = loadmat(folder / f"MultisineType{kind}.mat", squeeze_me=True)
    current, angle, reference = (_spectra(data[name]) for name in ("iq_adx", "theta_mx", "iq_refx"))
    level = abs(reference.mean(axis=0))
    band = np.arange(LOWEST, HIGHEST + 1)
    return Spectra(current, angle, band[level[band] > 0.1 * level.max()])


def _spectra(signal: np.ndarray) -> ComplexArray:
    periods = signal[DROPPED * PERIOD :].reshape(-1, PERIOD)
    return np.asarray(np.fft.rfft(periods) / PERIOD)


def rigid_body(data: FrequencyResponse) -> Model:
    """θ = b/(s² + a₁ s + a₂) from the slope of the response."""
    structure = RationalStructure(2, 0, frequency_scale=2 * np.pi * 50)
    gain = np.median(abs(data.response) * data.frequencies**2) / structure.frequency_scale**2
    dependence = ParameterDependence((STILL,), (ProductBasis((Polynomial(0),)),) * 3)
    return Model(structure, dependence, np.array([0.02, 0.02, gain]), np.eye(3), 1.0)


def story(data: FrequencyResponse, effects: int = 2) -> tuple[Step, ...]:
    """The rigid body and what the diagnosis adds to it."""
    return staircase(rigid_body(data), gather([data]), effects=library("mechanical"), largest=effects)


def line_classes(spectra: Spectra, model: Model) -> list[dict[str, Any]]:
    """Root mean square over the lines of each class in the band, in A at the input.

    V_k = mean over the periods of (Y − G U)/G,   G that of the model; deviations from how the periods differ
    """
    band = np.arange(LOWEST, HIGHEST + 1)
    model_response = linear_response(model, [[0.0]], 2 * np.pi * band * SAMPLE_RATE / PERIOD).response[0]
    beyond = spectra.angle[:, band] / model_response - spectra.current[:, band]
    noise = np.sqrt(np.var(beyond, axis=0, ddof=1) / len(beyond))
    excited = np.isin(band, spectra.excited)
    size = float(_rms(spectra.current.mean(axis=0)[spectra.excited]))
    rows: list[dict[str, Any]] = [{"class": "excited", "lines": int(excited.sum()), "ampere": size, "percent": 100.0}]
    for name, parity in (("unexcited odd", 1), ("unexcited even", 0)):
        chosen = ~excited & (band % 2 == parity)
        if chosen.any():
            level = float(_rms(beyond.mean(axis=0)[chosen]))
            rows.append({"class": name, "lines": int(chosen.sum()), "ampere": level, "percent": 100 * level / size})
            rows[-1]["noise ampere"] = float(_rms(noise[chosen]))
            rows[-1]["by line"] = np.column_stack([band[chosen], abs(beyond.mean(axis=0)[chosen])]).tolist()
    return rows


def _rms(values: np.ndarray) -> float:
    return float(np.sqrt(np.mean(abs(values) ** 2)))


def study(folder: Path, kind: str) -> dict[str, Any]:
    """The staircase and the line classes of one type of multisine."""
    spectra = read(folder, kind)
    data = spectra.response()
    steps = story(data)
    return {
        "type": kind,
        "steps": [_step(step, data) for step in steps],
        "line classes": line_classes(spectra, steps[-1].model),
        "hertz": (data.frequencies / (2 * np.pi)).tolist(),
        "measured": abs(data.response).tolist(),
    }


def _step(step: Step, data: FrequencyResponse) -> dict[str, Any]:
    return {
        "error": step.error,
        "effects": [
            {"kind": one.effect.kind, "amplitude": one.coefficients.ravel().tolist(), **_further(one.effect)}
            for one in step.model.effects
        ],
        "announced next": [one.score.candidate.effect.kind for one in step.diagnosis.announced],
        "response": abs(linear_response(step.model, [[0.0]], data.frequencies).response[0]).tolist(),
    }


def _further(effect: Any) -> dict[str, float]:
    return dict(zip(effect.fitted_names(), effect.values().tolist(), strict=True))


def table(result: dict[str, Any]) -> str:
    """The figures as text."""
    lines = [f"type {result['type']}"]
    for step in result["steps"]:
        last = step["effects"][-1] if step["effects"] else {"kind": "rigid body"}
        values = ", ".join(f"{name} {value}" for name, value in last.items() if name != "kind")
        lines.append(f"  {100 * step['error']:6.2f} %  {last['kind']:12s} {values}")
    for row in result["line classes"]:
        noise = f", noise {row['noise ampere']:.1e} A" if "noise ampere" in row else ""
        lines.append(
            f"  {row['class']:15s} {row['lines']:4d} lines  {row['ampere']:.2e} A  {row['percent']:.2f} %{noise}"
        )
    return "\n".join(lines)


def picture(results: list[dict[str, Any]], path: Path) -> None:
    """Measured and modelled size of the response, and the lines that were not excited, as one HTML page."""
    titles = [f"type {one['type']}: angle over current, rad/A" for one in results] + ["beyond the linear answer, A"]
    figure = new_figure(titles, height=900)
    for row, result in enumerate(results, start=1):
        figure.add_scatter(
            x=result["hertz"],
            y=result["measured"],
            mode="markers",
            name="measured",
            row=row,
            col=1,
            marker={"color": colour(0), "size": 4},
            showlegend=row == 1,
        )
        for i, step in enumerate(result["steps"]):
            name = step["effects"][-1]["kind"] if step["effects"] else "rigid body"
            figure.add_scatter(
                x=result["hertz"],
                y=step["response"],
                mode="lines",
                name=name,
                row=row,
                col=1,
                line={"color": colour(i + 1)},
                showlegend=row == 1,
            )
    for i, line_class in enumerate(results[-1]["line classes"][1:]):
        hertz, level = np.array(line_class["by line"]).T
        figure.add_scatter(
            x=hertz,
            y=level,
            mode="markers",
            name=line_class["class"],
            row=len(titles),
            col=1,
            marker={"color": colour(i + 4), "size": 5},
        )
    figure.update_yaxes(type="log")
    figure.update_xaxes(title="frequency, Hz", row=len(titles), col=1)
    figure.write_html(path, include_plotlyjs=True)


def main() -> None:
    """Parses the command line, runs, prints."""
    parser = command_line(__doc__, page=True)
    parser.add_argument("folder", type=Path, help="folder with MultisineTypeA.mat and MultisineTypeB.mat")
    options = parser.parse_args()
    results = [study(options.folder, kind) for kind in ("A", "B")]
    print("\n".join(table(one) for one in results))
    write_json(results, options.output)
    if options.page:
        picture(results, options.page)


if __name__ == "__main__":
    main()
