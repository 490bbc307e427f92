"""The example of [Ghosh2018, Section 5]: Table 1 with the search behind it, Figures 1 to 3, the numbers of its text."""

from collections.abc import Sequence
from itertools import combinations

import numpy as np
import plotly.graph_objects as go

from app.report.style import colour, dash, new_figure
from benchmarks.ghosh_example import DEPENDENCE, DEVIATIONS, GRID, NOISE_VARIANCE, STRUCTURE, THETA
from benchmarks.papers.gallery import Cell, Paper, Part, results
from identification.arrays import FloatArray
from identification.models.model import Model
from oed.design import Design, design
from oed.information import noise_information, sensitivity_moments
from oed.problem import DesignProblem
from oed.spectra.fir import FirSpectra
from oed.targets.parameter_deviation import ParameterDeviation

MODEL = Model(STRUCTURE, DEPENDENCE, THETA, np.eye(len(THETA)), NOISE_VARIANCE)
SAMPLES, DEGREE = 1000, 10
TABLE = {(0.0, 5.5): 7904, (0.0, 8.0): 18388, (1.5, 8.0): 32764, (0.0, 1.5): 57451}
ENERGIES = {0.0: 1019, 1.5: 1349, 8.0: 1143}
CAPPED = {0.0: 1000, 1.5: 1000, 2.0: 334, 7.5: 209, 8.0: 1000}
FIRST_POINTS = (0.0, 3.0, 5.5, 8.0)
ROUNDED = "the standard deviations are printed rounded; with a third each, as here, the figures come out"


def designed(points: FloatArray, cap: float | None = None) -> Design:
    """The optimum on operating points (M, 1), with at most `cap` of energy at each."""
    caps = None if cap is None else np.full(len(points), cap)
    targets, family = (ParameterDeviation(DEVIATIONS),), FirSpectra(DEGREE)
    return design(DesignProblem(MODEL, points, targets, family, SAMPLES, caps=caps))


def pairs() -> dict[tuple[float, float], float]:
    """The least energy of every pair of the 17 operating points."""
    return {
        (float(a), float(b)): designed(np.array([[a], [b]])).total_energy
        for a, b in combinations(GRID[:, 0].tolist(), 2)
    }


def white_power(points: Sequence[float] = FIRST_POINTS) -> float:
    """The least Φ, equal at all frequencies and points, at which P_θ⁻¹ ⪰ R_adm holds for 1000 samples each."""
    p = np.array(points)[:, None]
    moments = sensitivity_moments(MODEL, p, 0, 1.0)[:, 0].sum(axis=0) * SAMPLES
    k = MODEL.plant_size
    scale = np.array(DEVIATIONS[:k])
    own = np.linalg.eigvalsh(scale[:, None] * moments * scale)
    noise = noise_information(MODEL, p).sum(axis=0) * SAMPLES
    rest = np.array(DEVIATIONS[k:])
    if np.linalg.eigvalsh(rest[:, None] * noise * rest)[0] < 1:
        raise ArithmeticError("1000 samples do not tell the noise model well enough, whatever the input")
    return float(1 / own[0])


def paper(runs: int) -> Paper:
    """All parts, the two stages run so often."""
    optimum, every = designed(GRID), pairs()
    best = min(every, key=lambda pair: every[pair])
    table = [Cell("17 points, J_opt", 3511, optimum.total_energy, f"certified gap {optimum.gap:.0e}; {ROUNDED}")]
    table += [Cell(f"energy at p = {p:g}", e, _energy(optimum, p)) for p, e in ENERGIES.items()]
    table += [Cell(f"{{{a:g}, {b:g}}}", j, every[a, b]) for (a, b), j in TABLE.items()]
    table += [Cell(f"best of all {len(every)} pairs, {{{best[0]:g}, {best[1]:g}}}", 7904, every[best])]
    capped, low = designed(GRID, 1000.0), designed(GRID[GRID[:, 0] < 5])
    limits = [Cell("at most 1000 a point, J_opt", 3543, capped.total_energy)]
    limits += [Cell(f"energy at p = {p:g}", e, _energy(capped, p)) for p, e in CAPPED.items()]
    limits += [Cell("points below 5 only, J_opt, at 0, 1 and 4.5", 7357, low.total_energy, _where(low))]
    phi = white_power()
    text = [Cell("white noise at the first four points, Φ", 2.47, phi), Cell("its energy", 9880, 4 * SAMPLES * phi)]
    command = "python -m benchmarks.papers --only Ghosh2018"
    return Paper(
        "Ghosh2018",
        "Optimal experiment design, local approach",
        (
            Part("Table 1, and the search of all pairs", command, tuple(table)),
            Part("Figure 1: optimal spectra", command, pictures=(_spectra(optimum),)),
            Part("Figure 2: responses at the chosen points", command, pictures=(_responses(optimum),)),
            Part("Limits of energy (Remark 5), and points left out", command, tuple(limits)),
            Part("White noise in place of a design", command, tuple(text)),
            _two_stages(runs),
        ),
    )


def _two_stages(runs: int) -> Part:
    found = results("two_stage_study", "--runs", str(runs))
    said, energies = found["summary"], [run["energy"] for run in found["runs"]]
    draws = f"{runs} runs of our own draws"
    cells = (
        Cell("mean energy of the second experiment", 1741, said["mean energy"], draws, drawn=True),
        Cell("largest", 2319, said["largest energy"], draws, drawn=True),
        Cell(
            "worst total, the first experiment's 3000 included", 5319, 3000 + said["largest energy"], draws, drawn=True
        ),
        Cell("accepted in %", 99.8, 100 * said["accepted, two-step"] / runs, draws, drawn=True),
    )
    figure = new_figure()
    counts, edges = np.histogram(energies, bins=20)
    figure.add_bar(x=(edges[1:] + edges[:-1]) / 2, y=counts, marker={"color": colour(0)})
    figure.update_xaxes(title="energy of the second experiment")
    figure.update_yaxes(title="runs")
    picture = ("ghosh-figure-3", "Histogram of the cost of the second experiment", figure)
    command = f"python -m benchmarks.two_stage_study --runs {runs}"
    return Part("Figure 3: two stages, the parameters not known before", command, cells, (picture,))


def _energy(found: Design, p: float) -> float:
    return next((one.energy for one in found.experiments if abs(one.operating_point[0] - p) < 1e-9), 0.0)


def _where(found: Design) -> str:
    return "at " + ", ".join(f"{one.operating_point[0]:g}" for one in found.experiments)


def _spectra(found: Design) -> tuple[str, str, go.Figure]:
    omega, figure = np.linspace(0, np.pi, 400), new_figure()
    for i, one in enumerate(found.experiments):
        c = np.asarray(one.spectrum.coefficients)
        power = c[0] + 2 * np.cos(np.outer(omega, np.arange(1, len(c)))) @ c[1:]
        name, line = f"p = {one.operating_point[0]:g}", {"color": colour(i), "dash": dash(i)}
        figure.add_scatter(x=omega, y=power / found.samples, name=name, line=line, mode="lines")
    figure.update_xaxes(title="ω in rad per sample")
    figure.update_yaxes(title="Φ")
    return "ghosh-figure-1", "Optimal power spectra at the chosen operating points", figure


def _responses(found: Design) -> tuple[str, str, go.Figure]:
    omega, figure = np.geomspace(1e-3, np.pi, 300), new_figure()
    for i, one in enumerate(found.experiments):
        size = abs(MODEL.frequency_response([one.operating_point], omega)[0, :, 0, 0])
        name, line = f"p = {one.operating_point[0]:g}", {"color": colour(i), "dash": dash(i)}
        figure.add_scatter(x=omega, y=20 * np.log10(size), name=name, line=line, mode="lines")
    figure.update_xaxes(title="ω in rad per sample", type="log")
    figure.update_yaxes(title="|G| in dB")
    return "ghosh-figure-2", "Modulus of the response at the chosen operating points", figure
