"""False alarms of disturbed measurements, nothing missing: python -m benchmarks.disturbed_alarms --runs 40.

Seven conditions: white noise alone; an input that is held between samples, as is stated; the level of the sensor walks
at random; hum of thirty times the noise, not locked to the period; sampling instants with a jitter of 5 % of the sample
time; 10 % noise on the measured input; frequency responses without variances. A mass on a spring that grows stiffer
with the position, four operating points, two records at each. The steady answers are sums of sines evaluated at the
sampling instants, that to a held input goes from sample to sample; nothing is shared with the models. Announced is an
effect on the mean or one that is said to explain all that is missing; a hum that is named is no alarm.
"""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from scipy.signal import cont2discrete, lfilter

from benchmarks.command import command_line, write_json
from identification.arrays import ComplexArray, FloatArray
from identification.bases.polynomial import Polynomial
from identification.comparison.gather import gather
from identification.diagnosis.diagnose import Diagnosis, diagnose
from identification.models.model import Model
from identification.models.rational import RationalStructure
from identification.scheduling import ParameterDependence, ProductBasis, SchedulingVariable
from identification.signals import FrequencyResponse, TimeRecord

PERIOD, PERIODS, STEP = 256, 4, 0.05
LINES = np.arange(1, 62, 2)
OMEGA = np.asarray(2 * np.pi * LINES / (PERIOD * STEP), dtype=np.float64)
POINTS = (0.0, 0.3, 0.7, 1.0)
MASS, DAMPING, STIFFNESS, HARDER = 0.8, 1.1, 70.0, 45.0
NOISE = 0.01
POSITION = SchedulingVariable("position", "m", 0.0, 1.0)
DEPENDENCE = ParameterDependence((POSITION,), tuple(ProductBasis((Polynomial(n),)) for n in (0, 1, 0)))
START = np.array([DAMPING, STIFFNESS, HARDER, 1.0]) / MASS
MODEL = Model(RationalStructure(2, 0), DEPENDENCE, START, np.eye(4), 1.0)


def response(p: float, omega: FloatArray) -> ComplexArray:
    """Position over force, 1/(m s² + d s + k(p))."""
    return np.asarray(1 / (STIFFNESS + HARDER * p - MASS * omega**2 + 1j * DAMPING * omega))


def sines(amplitudes: ComplexArray, time: FloatArray) -> FloatArray:
    """Σ Re A_k e^{jω_k t}."""
    return np.asarray(np.real(np.exp(1j * np.multiply.outer(time, OMEGA)) @ amplitudes))


def record(p: float, g: np.random.Generator, jitter: float = 0.0) -> tuple[FloatArray, FloatArray, float]:
    """Input, output without other noise, and the deviation of the noise."""
    force = np.exp(2j * np.pi * g.random(len(LINES)))
    answer = response(p, OMEGA) * force
    time = np.asarray(STEP * np.arange(PERIOD * PERIODS), dtype=np.float64)
    noise = NOISE * float(np.sqrt(np.sum(abs(answer) ** 2) / 2))
    y = sines(answer, time + jitter * STEP * g.standard_normal(len(time)))
    return sines(force, time), y + noise * g.standard_normal(len(time)), noise


def white(p: float, g: np.random.Generator) -> TimeRecord:
    """White noise."""
    u, y, _ = record(p, g)
    return TimeRecord(u, y, STEP, (p,), PERIOD)


def held(p: float, g: np.random.Generator) -> TimeRecord:
    """The input is held between samples: the plant goes from sample to sample, three periods to settle."""
    u, _, noise = record(p, g)
    b, a, _ = cont2discrete(([1.0], [MASS, DAMPING, STIFFNESS + HARDER * p]), STEP)
    y = lfilter(np.ravel(b), a, np.tile(u[:PERIOD], 3 + PERIODS))[3 * PERIOD :]
    return TimeRecord(u, y + noise * g.standard_normal(len(u)), STEP, (p,), PERIOD, hold="zero")


def walking(p: float, g: np.random.Generator) -> TimeRecord:
    """The level walks by a fifth of the noise a sample."""
    u, y, noise = record(p, g)
    return TimeRecord(u, y + 0.2 * noise * np.cumsum(g.standard_normal(len(y))), STEP, (p,), PERIOD)


def humming(p: float, g: np.random.Generator) -> TimeRecord:
    """A sine of thirty times the noise beside the lines of the period."""
    u, y, noise = record(p, g)
    cycles = g.uniform(10.2, 10.8) + g.integers(0, 80)
    wave = 30 * noise * np.cos(2 * np.pi * cycles / PERIOD * np.arange(len(y)) + 7 * g.random())
    return TimeRecord(u, y + wave, STEP, (p,), PERIOD)


def jittered(p: float, g: np.random.Generator) -> TimeRecord:
    """Sampling instants off by 5 % of the sample time."""
    u, y, _ = record(p, g, 0.05)
    return TimeRecord(u, y, STEP, (p,), PERIOD)


def noisy_input(p: float, g: np.random.Generator) -> TimeRecord:
    """The input is measured with noise of a tenth of it."""
    u, y, _ = record(p, g)
    return TimeRecord(u + 0.1 * np.std(u) * g.standard_normal(len(u)), y, STEP, (p,), PERIOD)


def without_variances(p: float, g: np.random.Generator) -> FrequencyResponse:
    """A response with errors in proportion to it and no word about them."""
    omega = np.asarray(np.geomspace(OMEGA[0], OMEGA[-1], 50), dtype=np.float64)
    errors = NOISE * (g.standard_normal(50) + 1j * g.standard_normal(50)) / np.sqrt(2)
    return FrequencyResponse(omega, response(p, omega) * (1 + errors), (p,))


CONDITIONS: dict[str, Callable[[float, np.random.Generator], TimeRecord | FrequencyResponse]] = {
    "white": white,
    "held input": held,
    "random walk": walking,
    "hum": humming,
    "jitter": jittered,
    "input noise": noisy_input,
    "no variances": without_variances,
}


def one(condition: str, seed: int) -> Diagnosis:
    """The diagnosis of one campaign in which nothing is missing."""
    g = np.random.default_rng([*condition.encode(), seed])
    return diagnose(MODEL, gather([CONDITIONS[condition](p, g) for p in POINTS for _ in range(2)]), seed=seed)


def study(runs: int, conditions: Sequence[str]) -> dict[str, dict[str, Any]]:
    """What was announced in each condition, and the verdicts."""
    result = {}
    for condition in conditions:
        found = [one(condition, seed) for seed in range(runs)]
        kinds = [
            [each.score.candidate.effect.kind for each in d.announced]
            + ([] if d.variation is None else [d.variation.effect.kind])
            for d in found
        ]
        verdicts = [d.verdict for d in found]
        result[condition] = {
            "runs": runs,
            "announced": sum(bool(one) for one in kinds),
            "kinds": sorted({kind for one in kinds for kind in one}),
            "verdicts": {verdict: verdicts.count(verdict) for verdict in sorted(set(verdicts))},
        }
    return result


def main() -> None:
    """Parses the command line, runs, prints."""
    parser = command_line(__doc__ or "", runs=40)
    parser.add_argument("--only", nargs="+", default=list(CONDITIONS), choices=list(CONDITIONS), metavar="CONDITION")
    options = parser.parse_args()
    found = study(options.runs, options.only)
    for condition, row in found.items():
        kinds = ", ".join(row["kinds"])
        print(f"{condition:14s} announced {row['announced']} of {row['runs']}  {kinds}  {row['verdicts']}", flush=True)
    write_json(found, options.output)


if __name__ == "__main__":
    main()
