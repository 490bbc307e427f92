"""The numerical example of [Ghosh2018, Section 5] as requests, and the figures that it must reproduce.

The figures are those with σ = (0.003, 0.001/3, 0.1/3, 0.01/3) for θ_G and (0.35/3, 0.04/3) for θ_H, of which the
printed ones are roundings.
"""

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from identification.arrays import FloatArray
from identification.models.rational import RationalStructure
from identification.simulation import simulate
from tests.support.api import Api, Json

THETA = [-0.9, 0.1, 10.0, -1.0, -0.7, 0.08]
NOISE_VARIANCE = 0.5
DEVIATIONS = [0.003, 0.001 / 3, 0.1 / 3, 0.01 / 3, 0.35 / 3, 0.04 / 3]
STRUCTURE = RationalStructure(n_a=1, n_b=0, n_k=1, n_d=1, sample_time=1.0)
PLANT: Json = {
    "name": "the example of Ghosh et al.",
    "schedulingVariables": [{"name": "p", "minimum": 0.0, "maximum": 8.0}],
    "input": {"name": "u"},
    "output": {"name": "y"},
    "structure": {"timeDomain": "discrete", "sampleTimeSeconds": 1.0, "na": 1, "nb": 0, "nk": 1, "nd": 1},
    "basis": {"factors": [{"kind": "polynomial", "degree": 1}]},
}
GRID: Json = {"kind": "gridAxes", "axes": [{"minimum": 0.0, "maximum": 8.0, "count": 17}]}
BELOW_5: Json = {"kind": "gridAxes", "axes": [{"minimum": 0.0, "maximum": 4.5, "count": 10}]}
BOX: Json = {"kind": "box", "minimum": [0.0], "maximum": [8.0]}
LINES: Json = {"kind": "lines", "samples": 1000, "constant": True}


def fir(degree: int) -> Json:
    return {"kind": "fir", "degree": degree}


def only(*points: float) -> Json:
    return {"kind": "grid", "points": [[point] for point in points]}


@dataclass(frozen=True)
class Figure:
    """A design of the example: what is asked for, and the total energy and those per operating point to be found."""

    name: str
    energy: float
    energies: dict[float, float] = field(default_factory=dict)
    points: Json = field(default_factory=lambda: GRID)
    family: Json = field(default_factory=lambda: fir(10))
    cap: float | None = None

    def body(self, plant: Json, model: Json) -> Json:
        return {
            "plantId": plant["id"],
            "modelId": model["id"],
            "name": self.name,
            "operatingPoints": self.points,
            "targets": [{"kind": "parameter_deviation", "standardDeviations": DEVIATIONS}],
            "spectrumFamily": self.family,
            "samples": 1000,
            "energyCaps": self.cap and {"default": self.cap},
        }


FIGURES = (
    Figure("17 points, L = 10", 3510.4, {0.0: 1019.0, 1.5: 1349.0, 8.0: 1143.0}),
    Figure("Table 1, 0 and 5.5", 7903.0, points=only(0, 5.5)),
    Figure("Table 1, 0 and 8", 18387.0, points=only(0, 8)),
    Figure("Table 1, 1.5 and 8", 32763.0, points=only(1.5, 8)),
    Figure("Table 1, 0 and 1.5", 57447.0, points=only(0, 1.5)),
    Figure("at most 1000 a point", 3542.6, {0.0: 1000, 1.5: 1000, 2.0: 334, 7.5: 209, 8.0: 1000}, cap=1000.0),
    Figure("below 5", 7356.7, dict.fromkeys((0.0, 1.0, 4.5), 0.0), points=BELOW_5),
    Figure("17 points, L = 20", 3281.5, family=fir(20)),
    Figure("17 points, L = 40", 3015.6, family=fir(40)),
    Figure("17 points, L = 100", 2899.9, family=fir(100)),
    Figure("17 points, lines", 2855.2, family=LINES),
    Figure("p free, lines", 2854.6, points=BOX, family=LINES),
)


def prepared(api: Api) -> tuple[Json, Json]:
    """The plant and the model with the true parameters."""
    plant = api.post("/plants", PLANT)
    stated = {"plantId": plant["id"], "theta": THETA, "noiseVariance": NOISE_VARIANCE}
    return plant, api.post("/models/stated", stated)


def played(point: float, signal: FloatArray, generator: np.random.Generator | None) -> FloatArray:
    """The output of the true plant at an operating point, from rest, with the noise of the paper, if any."""
    zeta = np.array([THETA[0] + THETA[1] * point, THETA[2] + THETA[3] * point, THETA[4] + THETA[5] * point])
    noise = None if generator is None else generator.normal(scale=NOISE_VARIANCE**0.5, size=len(signal))
    return simulate(STRUCTURE, zeta, signal, noise)


def energies(design: Json) -> dict[float, float]:
    """The energy of each operating point of a design."""
    found: dict[float, Any] = {e["operatingPoint"][0]: e["energy"] for e in design["experiments"]}
    return found
