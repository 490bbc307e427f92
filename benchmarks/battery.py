"""Battery impedance over the state of charge: python -m benchmarks.battery FOLDER (where imiev_15C_eis.csv is).

Fits local models of growing order to 13 measured impedance spectra and a parameter-varying model over all of them.
Prints a table, and the same as JSON with --json FILE. Relative error: root mean square over the frequencies of
|Z − Ẑ|/|Z|.
"""

import argparse
import json
import time
from pathlib import Path
from typing import Any

import numpy as np

from identification.bases.chebyshev import Chebyshev
from identification.estimates import LocalEstimate, LpvEstimate
from identification.lpv.generalised_least_squares import GeneralisedLeastSquares
from identification.lpv.joint_likelihood import JointLikelihood
from identification.lti.rational_fit import RationalFit, relative_error
from identification.models import LocalModel, RationalStructure
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
) -> LpvEstimate:
    """The parameter-varying model, in two steps or by joint likelihood."""
    estimator = JOINT if joint else GeneralisedLeastSquares()
    return estimator.estimate(structure, dependence(structure, degree), data, tuple(local))


def errors(estimate: LpvEstimate, data: list[FrequencyResponse]) -> list[float]:
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
    parser = argparse.ArgumentParser(description="Battery impedance over the state of charge.")
    parser.add_argument("folder", type=Path, help="folder with imiev_15C_eis.csv")
    parser.add_argument("--degree", type=int, default=6, help="degree of the Chebyshev series")
    parser.add_argument("--json", type=Path, help="file for the figures")
    arguments = parser.parse_args()
    data = read(arguments.folder)
    rows = study(data, arguments.degree)
    print(table(rows, [one.operating_point[0] for one in data]))
    if arguments.json:
        arguments.json.write_text(json.dumps(rows, indent=1))


if __name__ == "__main__":
    main()
