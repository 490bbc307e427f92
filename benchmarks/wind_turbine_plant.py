"""The flapping dynamics of a wind turbine blade [Goos2014, Section 5]: plant, experiments and validation data."""

from dataclasses import replace
from functools import cache

import numpy as np
from scipy.signal import lfilter

from benchmarks.affine_plant import AffinePlant, with_constant
from identification.arrays import FloatArray
from identification.models.model import Model
from identification.models.state_space_model import stacks
from identification.scheduling import SchedulingVariable
from identification.varying.harmonic_noise import HarmonicNoise
from identification.varying.periodic_residuals import PeriodicResiduals
from identification.varying.records import VaryingRecord, steady_periods
from identification.varying.stacks import StackSizes, simulated

PLANT = AffinePlant(
    np.array([[[0.0, 0.0734], [-6.5229, -0.4997]], [[-0.0021, 0.0], [-0.0138, 0.5196]]]),
    np.array([[[-0.7221], [-9.6277]], [[0.0], [0.0]]]),
    np.array([[[1.0, 0.0]], [[0.0, 0.0]]]),
    np.zeros((2, 1, 1)),
    1.0,
    (SchedulingVariable("cosine of the blade angle", "1", -1.0, 1.0),),
)
SIZES = StackSizes.of(PLANT.matrices)
THETA = SIZES.join(PLANT.matrices)
PERIOD, SCHEDULING_PERIOD, SAMPLES = 500, 10, 50_000
COLOUR = (np.array([1.0, 0.5]), np.array([1.0, -0.8]))
VALIDATION_SAMPLES = 5000


def scheduling(samples: int, phase: float = 0.0) -> FloatArray:
    """cos(2πt/10 + φ), (samples, 1)."""
    return np.cos(2 * np.pi * np.arange(samples) / SCHEDULING_PERIOD + phase)[:, None]


@cache
def noise_free(kind: str, samples: int = SAMPLES, seed: int = 2014) -> VaryingRecord:
    """The experiment without noise: a "multisine" of all lines with random phases, or "white" noise, of power one."""
    generator = np.random.default_rng(seed)
    if kind == "multisine":
        lines = np.zeros(PERIOD // 2 + 1, dtype=complex)
        lines[1:-1] = np.exp(2j * np.pi * generator.random(PERIOD // 2 - 1))
        wave = np.fft.irfft(lines, PERIOD)
        u = np.tile(wave / wave.std(), samples // PERIOD)[:, None]
    else:
        u = generator.standard_normal((samples, 1))
    p = scheduling(len(u))
    return VaryingRecord(
        u, PLANT.simulate(u, p), p, 1.0, PERIOD if kind == "multisine" else SCHEDULING_PERIOD, PLANT.variables
    )


def disturbed(record: VaryingRecord, deviation: float, coloured: bool, generator: np.random.Generator) -> VaryingRecord:
    """The record with output noise of this standard deviation, white or through (1 + 0.5 q⁻¹)/(1 − 0.8 q⁻¹)."""
    e = generator.standard_normal((len(record) + 200, 1))
    if coloured:
        e = lfilter(*COLOUR, e, axis=0) / coloured_deviation()
    return replace(record, output=record.output + deviation * e[200:])


@cache
def coloured_deviation() -> float:
    """Standard deviation of the filtered noise."""
    pulse = np.zeros(500)
    pulse[0] = 1.0
    return float(np.linalg.norm(lfilter(*COLOUR, pulse)))


def cramer_rao(deviation: float, coloured: bool, samples: int = SAMPLES) -> tuple[FloatArray, FloatArray]:
    """The bound P_θ (size, size) at the true parameters and the true noise, and the chart Q there."""
    steady = steady_periods(noise_free("multisine", samples), drop_periods=1)
    residuals = PeriodicResiduals.of(steady, with_constant(steady.scheduling), PLANT.order)
    z = np.exp(-2j * np.pi * np.arange(PERIOD) / PERIOD)
    shape = np.polyval(COLOUR[0][::-1], z) / np.polyval(COLOUR[1][::-1], z) / coloured_deviation()
    power = deviation**2 * PERIOD / len(steady.output) * (abs(shape) ** 2 if coloured else np.ones(PERIOD))
    exact = replace(residuals, noise=HarmonicNoise(power[:, None, None].astype(complex), 10**9))
    chart = SIZES.chart(THETA)
    jacobian = exact(THETA)[1] @ chart
    return chart @ np.linalg.inv(jacobian.T @ jacobian) @ chart.T, chart


def aligned(model: Model) -> FloatArray:
    """θ of the model in the state basis nearest to that of the plant: θ − θ⁰ is perpendicular to changes of basis."""

    def observability(some: AffinePlant) -> FloatArray:
        return np.concatenate([some.c[0], some.c[0] @ some.a[0]])

    plant = AffinePlant.of(model)
    near = plant.transformed(np.linalg.solve(observability(plant), observability(PLANT)))
    tangent = SIZES.similarity_tangent(THETA)
    for _ in range(20):
        theta = SIZES.join(near.matrices)
        step = np.linalg.solve(tangent.T @ SIZES.similarity_tangent(theta), -tangent.T @ (theta - THETA))
        if np.abs(step).max() < 1e-13:
            break
        near = near.transformed(np.eye(PLANT.order) + step.reshape(PLANT.order, PLANT.order))
    return SIZES.join(near.matrices)


def validation_fits(models: list[Model], phase: float = 1.0, seed: int = 30) -> FloatArray:
    """VAF in % of each model on noise-free data of mean 10 and deviation 1 along a shifted p(t), all models at once."""
    u = 10 + np.random.default_rng(seed).standard_normal((VALIDATION_SAMPLES, 1))
    p = scheduling(VALIDATION_SAMPLES, phase)
    y = PLANT.simulate(u, p)
    a, b, c, d = (np.stack(parts) for parts in zip(*(stacks(model) for model in models), strict=True))
    error = simulated((a, b, c, d), u, with_constant(p))[1] - y
    with np.errstate(over="ignore", invalid="ignore"):
        fits = 100 * np.maximum(1 - np.var(error[..., 0], axis=-1) / np.var(y), 0.0)
    return np.where(np.isfinite(fits), fits, 0.0)
