"""A hidden effect in one channel of a plant with two inputs, two outputs and two scheduling variables.

Each run identifies the plant from responses with full covariance at seven operating points, without the effect, which
then has to be found, placed in the right channel and added; the error on two points held out is told before and after.
Without an effect the estimate is held against the truth: χ² of the responses at a point between, by their stated
covariance.

    python -m benchmarks.hidden_channel --runs 20 --output channels.json
"""

from dataclasses import asdict, dataclass

import numpy as np

from benchmarks.affine_plant import AffinePlant
from benchmarks.command import command_line, print_table, write_json
from identification.arrays import ComplexArray, FloatArray
from identification.bases.polynomial import Polynomial
from identification.comparison.gather import gather
from identification.diagnosis.diagnose import diagnose
from identification.diagnosis.staircase import refined, relative_error
from identification.methods.identify import identify
from identification.models.model import Model
from identification.models.state_space import StateSpaceStructure
from identification.scheduling import ProductBasis
from identification.signals import FrequencyResponse
from tests.support.varying import cox_plant

OMEGA = np.linspace(0.05, 3.1, 40)
POINTS = ((-0.9, -0.9), (-0.9, 0.9), (0.9, -0.9), (0.9, 0.9), (0.0, 0.0), (0.5, -0.3), (-0.4, 0.6))
HELD_OUT = ((0.2, 0.4), (-0.6, -0.2))
NOISE = 0.01
STRUCTURE = StateSpaceStructure(2, 2, 2, 1.0)
BASIS = ProductBasis((Polynomial(1),) * 2, total_degree=1)


@dataclass(frozen=True)
class Run:
    """What a run came to; the error on held-out points relative to the output, before and after, and that of noise."""

    effect: str
    output: int | None
    input: int | None
    found: bool
    placed: bool
    confident: bool
    verdict: str
    before: float
    after: float
    noise: float
    statistic: float


def hidden(generator: np.random.Generator) -> tuple[str, int | None, int | None, ComplexArray]:
    """A delay of 0.2 … 0.5 samples or a lag of that time constant in one path, at one output or at one input."""
    kind, place = generator.choice(["delay", "lag"]), int(generator.integers(3))
    size, output, entry = float(generator.uniform(0.2, 0.5)), int(generator.integers(2)), int(generator.integers(2))
    changed = np.exp(-1j * OMEGA * size) if kind == "delay" else 1 / (1 + 1j * OMEGA * size)
    factor = np.ones((len(OMEGA), 2, 2), dtype=np.complex128)
    rows = slice(None) if place == 2 else output
    columns = slice(None) if place == 1 else entry
    factor[:, rows, columns] = changed.reshape(-1, *(1,) * (factor[:, rows, columns].ndim - 1))
    return str(kind), None if place == 2 else output, None if place == 1 else entry, factor


def responses(
    plant: AffinePlant,
    points: tuple[tuple[float, float], ...],
    factor: ComplexArray,
    generator: np.random.Generator,
) -> list[FrequencyResponse]:
    """Noisy responses; the noise of the four entries is correlated, in another way at every point."""
    found = []
    for point in points:
        mixing = np.eye(4) + 0.4 * (generator.standard_normal((4, 4)) + 1j * generator.standard_normal((4, 4)))
        root = NOISE * mixing / np.sqrt(np.mean(abs(mixing) ** 2) * 4)
        noise = generator.standard_normal((len(OMEGA), 4, 2)) @ np.array([1, 1j]) / np.sqrt(2) @ root.T
        exact = plant.frequency_response(np.array([point]), OMEGA)[0] * factor
        covariance = np.repeat((root @ root.conj().T)[None], len(OMEGA), axis=0)
        found.append(FrequencyResponse(OMEGA, exact + noise.reshape(-1, 2, 2), point, 1.0, covariance=covariance))
    return found


def identified(data: list[FrequencyResponse], plant: AffinePlant) -> Model:
    """The model of the plant without the effect."""
    return identify(data, STRUCTURE, STRUCTURE.over(plant.variables, BASIS)).model


def one_run(seed: int) -> Run:
    """A hidden effect, looked for."""
    generator, plant = np.random.default_rng(seed), cox_plant()
    kind, output, entry, factor = hidden(generator)
    data = responses(plant, POINTS, factor, generator)
    model, batches = identified(data, plant), gather(data)
    held_out = gather(responses(plant, HELD_OUT, factor, generator))
    clean = gather(responses(plant, HELD_OUT, np.ones_like(factor), generator))
    found = diagnose(model, batches, seed=seed)
    best = found.best
    grown = found.base if best is None else refined(best.fit)
    last = None if best is None else best.fit.model.effects[-1]
    right = last is not None and last.effect.kind == kind
    return Run(
        kind,
        output,
        entry,
        right,
        right and last is not None and (last.port.output, last.port.input) == (output, entry),
        found.confident,
        found.verdict,
        relative_error(found.base.model, held_out),
        relative_error(grown.model, held_out),
        relative_error(plant.model(np.eye(len(model.theta))), clean),
        np.nan,
    )


def covariance_run(seed: int) -> float:
    """(Ĝ − G)ᵀ P⁻¹ (Ĝ − G) over the entries of the response at one line of a point between, 8 real numbers."""
    generator, plant = np.random.default_rng([seed, 1]), cox_plant()
    data = responses(plant, POINTS, np.ones((len(OMEGA), 2, 2), dtype=np.complex128), generator)
    return statistic(identified(data, plant), plant, np.array([[0.3, 0.2]]), np.array([0.7]))


def statistic(model: Model, plant: AffinePlant, point: FloatArray, omega: FloatArray) -> float:
    """χ² of all entries of the response together, (Re, Im) of each."""
    gradient = model.structure.gradient(model.coefficients(point), omega)
    sensitivity = model.pulled(gradient, point)[0, 0].reshape(-1, model.plant_size)
    parts = np.concatenate([sensitivity.real, sensitivity.imag])
    error = (model.frequency_response(point, omega) - plant.frequency_response(point, omega)).ravel()
    both = np.concatenate([error.real, error.imag])
    return float(both @ np.linalg.solve(parts @ model.plant_covariance @ parts.T, both))


def main() -> None:
    """Parses the command line, runs, prints."""
    parser = command_line(__doc__, runs=20, seed=1)
    options = parser.parse_args()
    runs = [one_run(options.seed + i) for i in range(options.runs)]
    squares = [covariance_run(options.seed + i) for i in range(options.runs)]
    rows: list[dict[str, object]] = [asdict(run) for run in runs]
    print_table(rows)
    print(f"found {np.mean([r.found for r in runs]):.0%}, placed {np.mean([r.placed for r in runs]):.0%}")
    print(f"χ² of the responses, expected 8: {np.mean(squares):.2f} ± {np.std(squares) / len(squares) ** 0.5:.2f}")
    write_json({"runs": rows, "statistics": squares}, options.output)


if __name__ == "__main__":
    main()
