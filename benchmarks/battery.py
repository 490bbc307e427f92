"""Battery impedance over the state of charge: python -m benchmarks.battery FOLDER (where imiev_15C_eis.csv is).

Fits local models of growing order to 13 measured impedance spectra and a parameter-varying model over all of them;
then asks the diagnosis what a resistor with one RC arc lacks, at half charge and over all states of charge. Prints
tables; --output writes them as JSON, --page the staircases as HTML. Relative error of the local
and joint fits: root mean square over the frequencies of |Z − Ẑ|/|Z|; of the staircases ‖Z − Ẑ‖/‖Z‖.
"""

import time
from pathlib import Path
from typing import Any

import numpy as np

from app.report.style import colour, new_figure
from benchmarks.command import command_line, write_json
from identification.bases.chebyshev import Chebyshev
from identification.bases.polynomial import Polynomial
from identification.comparison.gather import gather
from identification.diagnosis.staircase import Step, staircase
from identification.effects.library import library
from identification.estimates import Estimate, LocalEstimate
from identification.lpv.generalised_least_squares import GeneralisedLeastSquares
from identification.lpv.joint_likelihood import JointLikelihood
from identification.lti.rational_fit import RationalFit, relative_error
from identification.models.model import LocalModel, Model
from identification.models.rational import RationalStructure
from identification.scheduling import ParameterDependence, ProductBasis, SchedulingVariable
from identification.signals import FrequencyResponse

STRUCTURES = {
    "R + RC": RationalStructure(1, 1),
    "R + RC + L": RationalStructure(1, 2),
    "R + 2 RC + L": RationalStructure(2, 3),
    "R + 3 RC + L": RationalStructure(3, 4),
    "R + 4 RC + L": RationalStructure(4, 5),
}
CHARGE = SchedulingVariable("state of charge", "%", 5.0, 95.0)
FIT = RationalFit(weighting="relative", relaxation=True)
JOINT = JointLikelihood(unknown_variance="relative")
ONE_ARC = RationalStructure(1, 1, frequency_scale=10.0)


def read(folder: Path) -> list[FrequencyResponse]:
    """The impedance spectra, one for each state of charge in %."""
    table = np.genfromtxt(folder / "imiev_15C_eis.csv", delimiter=",", names=True)
    return [
        FrequencyResponse(2 * np.pi * rows["freq_Hz"], rows["Zre_ohm"] + 1j * rows["Zim_ohm"], (float(charge),), None)
        for charge in np.unique(table["soc_pct"])
        for rows in [table[table["soc_pct"] == charge]]
    ]


def local_estimates(structure: RationalStructure, data: list[FrequencyResponse]) -> list[LocalEstimate]:
    """A local model at every state of charge, weighted by 1/|Z|."""
    return [FIT.estimate(structure, one) for one in data]


def dependence(structure: RationalStructure, degree: int) -> ParameterDependence:
    """Every coefficient a Chebyshev series in the state of charge."""
    return ParameterDependence((CHARGE,), (ProductBasis((Chebyshev(degree),)),) * structure.size)


def varying(
    structure: RationalStructure, data: list[FrequencyResponse], local: list[LocalEstimate], degree: int, joint: bool
) -> Estimate:
    """The parameter-varying model, in two steps or by joint likelihood."""
    estimator = JOINT if joint else GeneralisedLeastSquares()
    return estimator.estimate(structure, dependence(structure, degree), data, tuple(local))


def errors(estimate: Estimate, data: list[FrequencyResponse]) -> list[float]:
    """Relative error of a parameter-varying model at each operating point."""
    model = estimate.model
    zeta = model.coefficients(np.array([one.operating_point for one in data]))
    return [
        relative_error(LocalModel(model.structure, one.operating_point, z, np.eye(len(z)), 1.0), one)
        for one, z in zip(data, zeta, strict=True)
    ]


def study(data: list[FrequencyResponse], degree: int) -> list[dict[str, Any]]:
    """One row a structure."""
    rows = []
    for name, structure in STRUCTURES.items():
        began = time.perf_counter()
        local = local_estimates(structure, data)
        row: dict[str, Any] = {"structure": name, "seconds": time.perf_counter() - began}
        row["local"] = [relative_error(e.model, one) for e, one in zip(local, data, strict=True)]
        row["converged"] = sum(e.outcome.ok for e in local)
        for kind, joint in (("two steps", False), ("joint", True)):
            began = time.perf_counter()
            estimate = varying(structure, data, local, degree, joint)
            row[kind] = {
                "errors": errors(estimate, data),
                "outcome": estimate.outcome.status,
                "advice": estimate.outcome.advice,
                "seconds": time.perf_counter() - began,
            }
        rows.append(row)
    return rows


def circuit(data: list[FrequencyResponse], degree: int) -> Model:
    """A resistor and one RC arc, polynomials in the state of charge through the local fits."""
    local = [FIT.estimate(ONE_ARC, one).model.zeta for one in data]
    how = ParameterDependence((CHARGE,), (ProductBasis((Polynomial(degree),)),) * ONE_ARC.size)
    stacked = how.matrix([one.operating_point for one in data]).reshape(-1, how.size)
    theta = np.linalg.lstsq(stacked, np.concatenate(local), rcond=None)[0]
    return Model(ONE_ARC, how, theta, np.eye(how.size), 1.0)


def story(data: list[FrequencyResponse], degree: int, amplitude_degree: int, effects: int = 3) -> tuple[Step, ...]:
    """What the diagnosis adds to a resistor with one RC arc; `amplitude_degree` of the amplitudes in p."""
    arcs = library("impedance")
    return staircase(circuit(data, degree), gather(data), effects=arcs, degree=amplitude_degree, largest=effects)


def told(name: str, steps: tuple[Step, ...]) -> dict[str, Any]:
    """The staircase as plain values; coefficients of amplitudes over the scaled state of charge."""
    return {
        "data": name,
        "errors": [step.error for step in steps],
        "announced": [[one.score.candidate.effect.kind for one in step.diagnosis.announced] for step in steps],
        "effects": [
            {"kind": one.effect.kind, "amplitude": one.coefficients.ravel().tolist()} for one in steps[-1].model.effects
        ],
    }


def staircases(data: list[FrequencyResponse]) -> list[dict[str, Any]]:
    """At half charge, and jointly over all states of charge."""
    half = [one for one in data if one.operating_point == (50.0,)]
    return [told("50 % state of charge", story(half, 0, 0)), told("all states of charge", story(data, 4, 1))]


def staircase_table(found: list[dict[str, Any]]) -> str:
    """Errors in %, what was announced before each step."""
    lines = []
    for one in found:
        lines.append(one["data"])
        names = ["R + RC", *(f"+ {effect['kind']}" for effect in one["effects"])]
        values = ["", *(", ".join(f"{value:.3e}" for value in effect["amplitude"]) for effect in one["effects"])]
        told_alike = ["", *(", ".join(kinds) for kinds in one["announced"])]
        for name, error, value, alike in zip(names, one["errors"], values, told_alike, strict=False):
            note = f"   amplitude {value}, announced: {alike}" if value else ""
            lines.append(f"  {100 * error:6.2f} %  {name:16s}{note}")
    return "\n".join(lines)


def picture(found: list[dict[str, Any]], path: Path) -> None:
    """The two staircases as an HTML page."""
    figure = new_figure([one["data"] + ": relative error, %" for one in found], height=600)
    for row, one in enumerate(found, start=1):
        names = ["R + RC", *(f"+ {effect['kind']}" for effect in one["effects"])]
        percent = [100 * error for error in one["errors"]]
        figure.add_bar(x=names, y=percent, marker={"color": colour(0)}, showlegend=False, row=row, col=1)
    figure.write_html(path, include_plotlyjs=True)


def table(rows: list[dict[str, Any]], charges: list[float]) -> str:
    """The rows as text, errors in %."""
    lines = [" " * 24 + "".join(f"{charge:7.0f}" for charge in charges) + "   % state of charge"]
    for row in rows:
        for kind, values, note in (
            ("local", row["local"], f"{row['seconds']:.2f} s, {row['converged']} converged"),
            *((k, row[k]["errors"], f"{row[k]['seconds']:.2f} s, {row[k]['outcome']}") for k in ("two steps", "joint")),
        ):
            label = f"{row['structure']:14s}{kind:10s}"
            lines.append(label + "".join(f"{100 * value:7.2f}" for value in values) + f"   {note}")
    return "\n".join(lines)


def main() -> None:
    parser = command_line(__doc__, page=True)
    parser.add_argument("folder", type=Path, help="folder with imiev_15C_eis.csv")
    parser.add_argument("--degree", type=int, default=6, help="degree of the Chebyshev series")
    options = parser.parse_args()
    data = read(options.folder)
    rows = study(data, options.degree)
    print(table(rows, [one.operating_point[0] for one in data]))
    found = staircases(data)
    print(staircase_table(found))
    write_json({"structures": rows, "staircases": found}, options.output)
    if options.page:
        picture(found, options.page)


if __name__ == "__main__":
    main()
