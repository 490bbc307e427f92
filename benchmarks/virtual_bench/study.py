"""What the virtual bench's studies share: the model the user believes in, calibrated strengths, measurements."""

import json
from functools import cache
from pathlib import Path

import numpy as np

from benchmarks.virtual_bench.bench import Bench, experiments, noisy
from benchmarks.virtual_bench.hidden import HIDDEN
from identification.bases.polynomial import Polynomial
from identification.comparison.gather import gather
from identification.effects.library import library
from identification.effects.second_variable import SecondVariable
from identification.extension.rows import Rows, plant_tangents
from identification.models.model import Model
from identification.models.rational import RationalStructure
from identification.scheduling import ParameterDependence, ProductBasis, SchedulingVariable

P = SchedulingVariable("p", "1", -1.0, 1.0)


def _model(order, theta, degrees):
    dependence = ParameterDependence((P,), tuple(ProductBasis((Polynomial(n),)) for n in degrees))
    return Model(RationalStructure(order, 0), dependence, np.array(theta), np.eye(len(theta)), 1.0)


MODEL = _model(2, [1.8, 64.0, 28.0, 1.0], (0, 1, 0))
FIRST_ORDER = _model(1, [3.0, 1.4, 1.0], (1, 0))
STRENGTHS = Path(__file__).with_name("strengths.json")
MISFIT = 0.03


def effects(done):
    """The library, with what was logged beside the operating point."""
    logged = tuple(float(x) for x in np.sin(7.0 * np.arange(len(done.points))))
    return tuple(SecondVariable(logged) if one.kind == "second_variable" else one for one in library())


def design(points=7):
    """The experiments of the studies: two levels at each operating point."""
    return experiments(np.random.default_rng(2024), points=points)


def misfit(done, kind, strength):
    """Share of the root mean square of the output that θ cannot take up, with this effect hidden."""
    clean, with_effect = Bench().steady(done), Bench(((kind, strength),)).steady(done)
    batches = gather(noisy(clean, done, 1e-2, np.random.default_rng(0)))
    rows = Rows(batches)
    flow = MODEL.respond(batches[0])
    weights = batches[0].weights
    tangents = plant_tangents(MODEL, rows, [flow])
    change = np.fft.rfft(with_effect - clean) / clean.shape[1]
    basis = np.linalg.qr(tangents.T)[0]
    change_rows = batches[0].whiten(change)
    left = change_rows - basis @ (basis.T @ change_rows)
    size = np.fft.rfft(clean) / clean.shape[1]
    return float(np.linalg.norm(left) / np.linalg.norm(size * weights))


def calibrated(done, kind):
    """The strength of a hidden effect at which its misfit is three per cent."""
    strength = HIDDEN[kind].guess
    for _ in range(3):
        strength *= MISFIT / misfit(done, kind, strength)
        if kind in ("saturation", "sensor_saturation", "dead_zone", "sensor_dead_zone", "backlash", "antiresonance"):
            strength = min(strength, 1.0)
    return strength


@cache
def strengths():
    """The calibrated strengths, from the file beside this module or computed anew."""
    if STRENGTHS.exists():
        return json.loads(STRENGTHS.read_text())
    done = design()
    found = {kind: calibrated(done, kind) for kind in HIDDEN}
    STRENGTHS.write_text(json.dumps(found, indent=1) + "\n")
    return found


@cache
def steady(kinds):
    """Design of the experiments and the noise-free output with these kinds hidden."""
    done = design()
    return done, Bench(tuple((kind, strengths()[kind]) for kind in kinds)).steady(done)


def measured(kinds, share, generator, **noise):
    """Batches of noisy records with these kinds hidden."""
    done, y = steady(tuple(kinds))
    return gather(noisy(y, done, share, generator, **noise))
