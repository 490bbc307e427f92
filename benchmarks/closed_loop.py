"""Plants measured in a loop without a period: python -m benchmarks.closed_loop --runs 500.

u = r − C y around 0.5 z⁻¹/(1 − 0.95 z⁻¹), white r that is not given, 8192 samples; noise 1/(1 − 0.95 z⁻¹) and
(1 + 0.7 z⁻¹)/(1 − 1.6 z⁻¹ + 0.8 z⁻²) of unit innovations; controllers of gain one and with an integrator. The
structure has no noise model. The loops are computed sample by sample. Prints the bias, how many 95 % intervals hold the
truth and their 99 % binomial interval, rejections of the joint χ² at 5 %, and how often feedback is found, in the
loop and in the open. --samples changes the length; --output writes JSON.
"""

from functools import partial
from typing import Any

import numpy as np
from scipy import stats
from scipy.signal import lfilter

from benchmarks.command import command_line, write_json
from benchmarks.processes import spread
from identification.arrays import FloatArray
from identification.lti.prediction_error import PredictionError
from identification.measurements.feedback import feedback_seen
from identification.models.rational import RationalStructure
from identification.signals import TimeRecord

PLANT = RationalStructure(n_a=1, n_b=0, n_k=1, sample_time=1.0)
TRUTH = np.array([-0.95, 0.5])
NOISES = {"1/(1 - 0.95 q)": ([1.0], [1.0, -0.95]), "(1 + 0.7 q)/(1 - 1.6 q + 0.8 q²)": ([1.0, 0.7], [1.0, -1.6, 0.8])}
CONTROLLERS = {"gain": (1.0, 0.0), "with an integrator": (0.4, 0.02)}


def looped(
    noise: tuple[list[float], list[float]], gains: tuple[float, float], g: np.random.Generator, samples: int
) -> tuple[FloatArray, FloatArray]:
    """u and y (N,) of u = r − k y − h Σ y."""
    r, e = g.standard_normal((2, samples))
    v = lfilter(*noise, e)
    u, y = np.empty((2, samples))
    x = total = 0.0
    for t in range(samples):
        y[t] = x + v[t]
        total += y[t]
        u[t] = r[t] - gains[0] * y[t] - gains[1] * total
        x = 0.95 * x + 0.5 * u[t]
    return u, y


def one(seed: np.random.SeedSequence, samples: int = 8192) -> dict[str, list[float]]:
    """For every condition ζ̂ − ζ, its deviations, the distance squared, and whether feedback was seen in the loop and
    in the open."""
    g, found = np.random.default_rng(seed), {}
    for name, noise in NOISES.items():
        for kind, gains in CONTROLLERS.items():
            record = TimeRecord(*looped(noise, gains, g, samples), 1.0, (0.0,))
            alone = TimeRecord(*looped(noise, (0.0, 0.0), g, samples), 1.0, (0.0,))
            stated = TimeRecord(record.input, record.output, 1.0, (0.0,), feedback=True)
            model = PredictionError().estimate(PLANT, stated).model
            off = model.zeta - TRUTH
            distance = float(off @ np.linalg.solve(model.covariance, off))
            seen = [float(feedback_seen(each, delayed=True) is not None) for each in (record, alone)]
            found[f"{name}, {kind}"] = [*off, *np.sqrt(np.diag(model.covariance)), distance, *seen]
    return found


def row(values: FloatArray) -> dict[str, Any]:
    """The figures of one condition from its runs (runs, 7)."""
    off, deviations, distance = values[:, :2], values[:, 2:4], values[:, 4]
    return {
        "runs": len(values),
        "bias in per cent": (100 * off.mean(axis=0) / TRUTH).tolist(),
        "its deviation": (100 * off.std(axis=0) / abs(TRUTH) / np.sqrt(len(values))).tolist(),
        "held by their intervals": np.sum(abs(off) < 1.959964 * deviations, axis=0).tolist(),
        "of 99 % binomial interval": [float(end) for end in stats.binom.interval(0.99, len(values), 0.95)],
        "rejected by joint chi squared": int(np.sum(distance > stats.chi2.isf(0.05, 2))),
        "feedback found in the loop": int(values[:, 5].sum()),
        "feedback claimed in the open": int(values[:, 6].sum()),
    }


def main() -> None:
    """Parses the command line, runs, prints."""
    parser = command_line(__doc__ or "", runs=500, seed=11)
    parser.add_argument("--samples", type=int, default=8192)
    options = parser.parse_args()
    found = spread(partial(one, samples=options.samples), options.runs, options.seed, options.workers)
    result = {name: row(np.array([each[name] for each in found])) for name in found[0]}
    for name, figures in result.items():
        print(name)
        for what, value in figures.items():
            print(f"  {what:32s} {value}", flush=True)
    write_json(result, options.output)


if __name__ == "__main__":
    main()
