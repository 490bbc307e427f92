"""One small plant of every structure, what is measured of it, which effect is added, and how a model is asked for."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from tests.support import varying
from tests.support.api import Json

STEP, LINES = 0.5, np.arange(1, 61) * 2 * np.pi / (128 * 0.5)
POINTS = (0.0, 0.25, 0.5, 0.75, 1.0)
HIDDEN, NOISE = 0.05, 0.002
CONSTANT, AFFINE = ({"factors": [{"kind": "polynomial", "degree": degree}]} for degree in (0, 1))
RATIONAL: Json = {"localEstimator": {"kind": "rational_fit"}, "lpvEstimator": {"kind": "joint_likelihood"}}
STATE_SPACE: Json = {
    "kind": "stateSpace",
    "parametricEstimator": {"kind": "parametric_subspace"},
    "refinement": {"kind": "state_space_likelihood"},
}


@dataclass(frozen=True)
class LoopPlant:
    """A structure by its name in the table; `response(p, ω)` (F, n_y, n_u) in physics, not by the models."""

    name: str
    structure: Json
    request: Json
    response: Callable[[float, np.ndarray], np.ndarray] | None = None
    channels: tuple[int, int] = (1, 1)
    bases: tuple[str, ...] = ()
    effect: str = "feedthrough"

    @property
    def lists(self) -> bool:
        """Whether it has lists of inputs and outputs."""
        return "StateSpace" in self.structure["timeDomain"]

    def description(self) -> Json:
        """The plant to post."""
        if self.response is None:
            return varying.TURBINE
        outputs, inputs = self.channels
        signals: Json = {"input": {"name": "u"}, "output": {"name": "y"}}
        if self.lists:
            signals = {
                "inputs": [{"name": f"u{i}"} for i in range(inputs)],
                "outputs": [{"name": f"y{i}"} for i in range(outputs)],
            }
        return {
            "name": self.name,
            "schedulingVariables": [{"name": "p", "minimum": 0.0, "maximum": 1.0}],
            **signals,
            "structure": self.structure,
            "basis": CONSTANT,
            "coefficientBases": [{"coefficient": one, "basis": AFFINE} for one in self.bases],
        }

    def fitted(self, plant: Json) -> list[Json]:
        """Bodies of the experiments that a model is identified from."""
        if self.response is None:
            return [varying.body(plant, varying.turbine(1))]
        return self.held_still(plant)

    def held_still(self, plant: Json) -> list[Json]:
        """Bodies of experiments at operating points held still."""
        if self.response is None:
            return [{**varying.still(point, 3), "plantId": plant["id"]} for point in (-0.8, -0.2, 0.3, 0.9)]
        return [self._measured(plant, point) for point in POINTS]

    def _measured(self, plant: Json, point: float) -> Json:
        assert self.response is not None
        generator = np.random.default_rng([5, round(100 * point)])
        truth = self.response(point, LINES) + HIDDEN
        noise = NOISE / np.sqrt(2) * (generator.standard_normal((2, *truth.shape)).T @ [1, 1j]).T
        values, variance = truth + noise, np.full(truth.shape, NOISE**2)
        if self.channels == (1, 1):
            values, variance = values[:, 0, 0], variance[:, 0, 0]
        return {
            "plantId": plant["id"],
            "kind": "frequencyResponse" if self.channels == (1, 1) else "matrixFrequencyResponse",
            "operatingPoint": [point],
            "sampleTimeSeconds": self.structure.get("sampleTimeSeconds"),
            "frequenciesRadPerSecond": LINES.tolist(),
            "response": {"re": values.real.tolist(), "im": values.imag.tolist()},
            "variance": variance.tolist(),
        }


def _single(values: np.ndarray) -> np.ndarray:
    return np.asarray(values)[:, None, None]


def _tanks(p: float, omega: np.ndarray, outputs: int, inputs: int) -> np.ndarray:
    """Three tanks that flow into each other, sampled: C (zI − A)⁻¹ B."""
    a = np.array([[0.5 + 0.1 * p, 0.2, 0.0], [0.1, 0.4, 0.2], [0.0, 0.3, 0.6 - 0.2 * p]])
    b, c = np.array([[1.0, 0.2, 0.0], [0.0, 0.5, 0.3], [0.4, 0.0, 1.0]]), np.array([[1.0, 0.0, 0.5], [0.0, 1.0, 0.3]])
    z = np.exp(1j * omega * STEP)[:, None, None]
    return np.asarray(c[:outputs] @ np.linalg.solve(z * np.eye(3) - a, b[:, :inputs].astype(complex)[None]))


SAMPLED = {"sampleTimeSeconds": STEP}
PHYSICAL: Json = {
    "timeDomain": "continuousPhysical",
    "denominator": [{"name": "J"}, {"name": "d"}],
    "numerator": [{"name": "k", "fixedAt": 1.0}],
}
PLANTS: Sequence[LoopPlant] = (
    LoopPlant(
        "rational, discrete",
        {"timeDomain": "discrete", **SAMPLED, "na": 1, "nb": 0, "nk": 1},
        RATIONAL,
        lambda p, w: _single(0.4 * np.exp(-1j * w * STEP) / (1 - (0.8 - 0.1 * p) * np.exp(-1j * w * STEP))),
        bases=("a1",),
    ),
    LoopPlant(
        "rational, continuous",
        {"timeDomain": "continuous", "na": 1, "nb": 0},
        RATIONAL,
        lambda p, w: _single(1 / (1j * w + 1 + 0.5 * p)),
        bases=("a1",),
    ),
    LoopPlant(
        "rational, with delay",
        {"timeDomain": "continuous", "na": 1, "nb": 0, "delay": True},
        RATIONAL,
        lambda p, w: _single(np.exp(-0.3j * w) / (1j * w + 1 + 0.5 * p)),
        bases=("a1",),
    ),
    LoopPlant(
        "physical form",
        PHYSICAL,
        RATIONAL,
        lambda p, w: _single(1 / ((1 + 0.5 * p) * 1j * w + 1)),
        bases=("J",),
    ),
    LoopPlant(
        "state space, 1 × 1",
        {"timeDomain": "discreteStateSpace", **SAMPLED, "order": 3},
        STATE_SPACE,
        lambda p, w: _tanks(p, w, 1, 1),
        bases=("A",),
    ),
    LoopPlant(
        "state space, 2 × 3",
        {"timeDomain": "discreteStateSpace", **SAMPLED, "order": 3},
        STATE_SPACE,
        lambda p, w: _tanks(p, w, 2, 3),
        (2, 3),
        bases=("A",),
    ),
    LoopPlant(
        "from varying scheduling",
        varying.TURBINE["structure"],
        {"kind": "varyingScheduling", "estimator": {"kind": "periodic_likelihood"}},
        effect="delay",
    ),
)
