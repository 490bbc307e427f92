"""The academic example of parametric subspace identification: exact without noise, and what noise does to its poles.

python -m benchmarks.kergus_example [--runs 200] [--output FILE.json] [--page FILE.html]
"""

import time
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.command import command_line, write_json
from identification.bases.polynomial import Polynomial
from identification.parametric.parametric_subspace import ParametricSubspace
from identification.pole_regions.disc import Disc
from identification.scheduling import ParameterDependence, ProductBasis, SchedulingVariable
from identification.signals import FrequencyResponse

SAMPLE_TIME = 1e-3
LINES = np.logspace(-1, np.log10(np.pi / SAMPLE_TIME), 400)
AFFINE = ParameterDependence((SchedulingVariable("p", "", 0.0, 1.0),), (ProductBasis((Polynomial(1),)),) * 4)
MEASURED = (0.2, 0.8)
SNR = 5.0
EVERYWHERE = np.linspace(0.0, 1.0, 10_001)[:, None]
SHOWN = np.linspace(0.0, 1.0, 11)[:, None]
METHODS = {
    "Algorithm 1": ParametricSubspace(2, 10, "none"),
    "Algorithm 2": ParametricSubspace(2, 10, "none", region=Disc()),
    "Algorithm 2, spectral norm": ParametricSubspace(2, 10, "none", region=Disc(), misfit="spectral"),
}


def truth(p: float) -> Any:
    """(1 + p)/(z² + 0.01 p z + 0.99) at the lines [Kergus2019, (25)]."""
    z = np.exp(1j * LINES * SAMPLE_TIME)
    return (1 + p) / (z**2 + 0.01 * p * z + 0.99)


def data(generator: np.random.Generator | None = None) -> list[FrequencyResponse]:
    """Both responses, noise-free or with the noise of [Kergus2019, (28)] at SNR = 5."""
    result = []
    for p in MEASURED:
        response = truth(p)
        if generator is not None:
            response = response * (1 + 10 ** (-SNR / 10) * (generator.standard_normal((len(LINES), 2)) @ [1, 1j]))
        result.append(FrequencyResponse(LINES, response, (p,), SAMPLE_TIME))
    return result


def distance(model: Any) -> float:
    """Relative error against the true plant, over eleven values of p and all lines."""
    plant = np.array([truth(p) for p in SHOWN[:, 0]])
    found = model.frequency_response(SHOWN, LINES)[..., 0, 0]
    return float(np.linalg.norm(found - plant) / np.linalg.norm(plant))


def noise_free() -> dict[str, Any]:
    """The largest relative errors without noise."""
    return {name: distance(method.estimate(AFFINE, data()).model) for name, method in METHODS.items()}


def with_noise(runs: int) -> dict[str, Any]:
    """How often each method is unstable somewhere in [0, 1], and its errors against the data and the plant."""
    rows: dict[str, dict[str, list[float]]] = {
        name: {"unstable": [], "fit": [], "distance": [], "seconds": []} for name in METHODS
    }
    for seed in range(runs):
        records = data(np.random.default_rng(seed))
        for name, method in METHODS.items():
            start = time.perf_counter()
            found = method.estimate(AFFINE, records)
            rows[name]["seconds"].append(time.perf_counter() - start)
            rows[name]["unstable"].append(float(not found.model.stable(EVERYWHERE).all()))
            misfit = [np.linalg.norm(e.relative) for e in found.errors]
            rows[name]["fit"].append(float(np.mean(misfit)))
            rows[name]["distance"].append(distance(found.model))
    return {name: _summary(row) for name, row in rows.items()}


def _summary(row: dict[str, list[float]]) -> dict[str, float]:
    return {
        "unstable": int(sum(row["unstable"])),
        "runs": len(row["unstable"]),
        "medianRelativeMisfit": float(np.median(row["fit"])),
        "upperDecileRelativeMisfit": float(np.quantile(row["fit"], 0.9)),
        "medianDistanceToPlant": float(np.median(row["distance"])),
        "upperDecileDistanceToPlant": float(np.quantile(row["distance"], 0.9)),
        "medianSeconds": float(np.median(row["seconds"])),
    }


def picture(page: Path) -> None:
    """The upper pole over p for plant, Algorithm 1 and Algorithm 2 on the first data set that upsets Algorithm 1."""
    import plotly.graph_objects as go

    for seed in range(100):
        records = data(np.random.default_rng(seed))
        models = {name: METHODS[name].estimate(AFFINE, records).model for name in list(METHODS)[:2]}
        if not models["Algorithm 1"].stable(EVERYWHERE).all():
            break
    plant = [complex(max(np.roots([1, 0.01 * p, 0.99]), key=np.imag)) for p in SHOWN[:, 0]]
    figure = go.Figure()
    angle = np.linspace(1.2, 1.9, 200)
    figure.add_scatter(x=np.cos(angle), y=np.sin(angle), mode="lines", name="unit circle", line_color="black")
    figure.add_scatter(x=np.real(plant), y=np.imag(plant), mode="markers", name="plant")
    for name, model in models.items():
        poles = model.poles(SHOWN)
        upper = poles[np.arange(len(poles)), poles.imag.argmax(axis=1)]
        figure.add_scatter(x=upper.real, y=upper.imag, mode="markers", name=name)
    figure.update_layout(
        title=f"Upper pole for p = 0, 0.1 … 1 (data set {seed})", xaxis_title="Re z", yaxis_title="Im z"
    )
    figure.write_html(page, include_plotlyjs=True)


def main() -> None:
    """Print the table, and write it and the picture."""
    arguments = command_line(__doc__, runs=200, page=True).parse_args()
    result = {"noiseFree": noise_free(), "noisy": with_noise(arguments.runs)}
    print("noise-free relative errors", result["noiseFree"])
    for name, row in result["noisy"].items():
        print(
            f"{name:28s} unstable {row['unstable']:3d} of {row['runs']}   misfit {row['medianRelativeMisfit']:.3f}"
            f" (90 %: {row['upperDecileRelativeMisfit']:.3f})   distance to plant {row['medianDistanceToPlant']:.3f}"
            f" (90 %: {row['upperDecileDistanceToPlant']:.3f})   {1e3 * row['medianSeconds']:.1f} ms"
        )
    write_json(result, arguments.output)
    if arguments.page:
        picture(arguments.page)


if __name__ == "__main__":
    main()
