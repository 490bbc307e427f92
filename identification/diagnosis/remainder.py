"""What a fit leaves beside noise: a smooth part at the excited lines, more power at the others."""

from dataclasses import dataclass

import numpy as np
from scipy.special import chdtrc

from identification.arrays import BoolArray, ComplexArray, FloatArray
from identification.comparison.batch import CLASS_NAMES, EXCITED, Batch
from identification.extension.fit import Fit
from identification.outcome import TestResult
from identification.places.place import Flow

NODES, POINT_NODES, WIDTH = 24, 5, 0.3
MATERIAL = 0.005
SIZES = np.concatenate([[0.0], np.geomspace(1e-5, 3.0, 45)])
COARSE = SIZES[::3]
ROUNDS = 2
DRAWS = 1000


@dataclass(frozen=True, eq=False)
class Remainder:
    """r ~ N(J β, V + τ² S) at its restricted likelihood.

    `cost` −2 ln L, less that of noise alone; `immaterial` the same with τ and what the other lines have beyond noise
    held below what is material; `size` τ̂, relative to the response; `excess` of each class of unexcited lines over
    noise; `noise` σ̂² in units of what was stated; `hyperparameters` how many are free.
    """

    cost: float
    immaterial: float
    size: float
    excess: tuple[float, ...]
    noise: float
    hyperparameters: int


class SmoothRemainder:
    """V + τ² S for the rows of a fit.

        δY(p, ω) = |Ŷ(p, ω)| g(p, ln ω) e^{j arg Ŷ},   g complex Gaussian, smooth: S = Φ Φᵀ,  Φ = K_xz K_zz^{−½}

    K a Matérn covariance 3/2 over nodes z, `NODES` over the excited band (three tenths of it wide) and up to
    `POINT_NODES` over p (as wide as half the range); odd and even unexcited lines have variances 1 + κ of their own.
    Where the size of the noise is not known it is profiled out. A smooth model error is what any missing linear effect
    of unknown shape leaves; one to three hyperparameters are its price [RasmussenWilliams2006, Sections 2.2, 5.4].
    """

    def __init__(self, base: Fit, material: float = MATERIAL) -> None:
        self.base, self.material = base, material
        self.classes = [_class_rows(base, number) for number in range(len(CLASS_NAMES))]
        self._factors = [_factor(batch, flow.output, s) for batch, flow, s in self._triples()]
        self._features = _features(base)
        self.values, self._vectors = self._spectrum()

    def _triples(self) -> list[tuple[Batch, Flow, float]]:
        return list(zip(self.base.rows.batches, self.base.flows, self.base.rows.scales, strict=True))

    def _spectrum(self) -> tuple[FloatArray, FloatArray]:
        total: FloatArray = np.zeros((0, 0))
        for factor, (at_points, over) in zip(self._factors, self._features, strict=True):
            inner = np.einsum("ki,mk,kj->mij", over, abs(factor) ** 2, over, optimize=True)
            part = np.einsum("ma,mb,mij->aibj", at_points, at_points, inner, optimize=True)
            part = part.reshape(at_points.shape[1] * over.shape[1], -1)
            total = part if not total.size else total + part
        values, vectors = np.linalg.eigh(total)
        kept = values > 1e-12 * max(values[-1], 1e-300)
        return np.maximum(values[kept], 0.0), vectors[:, kept]

    def onto(self, rows: FloatArray) -> ComplexArray:
        """Φᵀ of rows (c, R) in the axes of S, (c, n)."""
        total: ComplexArray = np.zeros((len(rows), len(self._vectors)), dtype=np.complex128)
        parts = self.base.rows.parts(rows)
        for part, factor, (at_points, over), batch in zip(
            parts, self._factors, self._features, self.base.rows.batches, strict=True
        ):
            halves = part.reshape(len(rows), len(batch.points), 2, -1)
            z = halves[:, :, 0] + 1j * halves[:, :, 1]
            inner = (factor.conj() * z) @ over
            total += np.einsum("ma,cmi->cai", at_points, inner).reshape(len(rows), -1)
        return np.asarray(total @ self._vectors)

    def of(self, found: Fit) -> Remainder:
        """The remainder of a fit to the rows of this model."""
        return _Likelihood(self, found).maximised()

    def test(self, name: str, found: Fit, seed: int = 0) -> TestResult:
        """Whether a smooth remainder is there, with noise of unknown size: restricted likelihood ratio of τ² = 0.

        Its null distribution is simulated from the eigenvalues of S off the fitted parameters [CrainiceanuRuppert2004].
        """
        return _Likelihood(self, found).tested(name, np.random.default_rng(seed))


def rest(found: Fit, noise: float = 1.0) -> float:
    """‖Y − Ŷ‖/‖Y‖ without what noise has in it: the root of Σ|Y − Ŷ|² − Σσ² over all lines to that of |Y|², or 0.

    `noise`: by how much the variances are larger than stated, each line counted for what the fit leaves of it. Where
    the noise of a record was found from what the model leaves, at least what lies in its general directions counts, as
    far as that is more than noise puts there.
    """
    left = size = 0.0
    share = 1 - len(found.tangents) / found.rows.count
    judged = found.rows.parts(found.rows.judged(found.residual))
    freedom = found.rows.parts(found.rows.shares)
    pairs = zip(found.rows.batches, found.flows, found.rows.scales, strict=True)
    for (batch, flow, scale), part, free in zip(pairs, judged, freedom, strict=True):
        used = np.isfinite(batch.variances)
        power = scale**2 * np.where(batch.real, 0.5, 1.0) * batch.variances
        expected = share * noise * power
        if batch.varied is not None:
            expected = expected + np.sum(abs(batch.varied) ** 2, axis=1)
        beyond = float(np.sum(np.where(used, abs(batch.outputs - flow.output) ** 2 - expected, 0.0)))
        if batch.general is not None:
            excess = max(0.0, 1 - float(free.sum()) / max(float(part @ part), np.finfo(float).tiny))
            seen = float(np.sum(np.where(used, abs(batch.complex_residual(part)) ** 2 * power, 0.0)))
            beyond = max(beyond, excess * seen)
        left += beyond
        size += float(np.sum(np.where(used & (batch.classes == EXCITED), abs(batch.outputs) ** 2, 0.0)))
    return float(np.sqrt(max(left, 0.0) / size)) if size > 0 else 0.0


def _class_rows(base: Fit, number: int) -> BoolArray:
    chosen = [np.repeat((batch.classes == number)[:, None], 2, axis=1).ravel() for batch in base.rows.batches]
    compared = [batch.compared for batch in base.rows.batches]
    return np.concatenate(chosen) & np.concatenate(compared)


def _factor(batch: Batch, output: ComplexArray, scale: float) -> ComplexArray:
    """What a relative change of the response by one is in whitened rows, (M, K)."""
    used = (batch.classes == EXCITED) & np.isfinite(batch.variances) & (batch.omega > 0)
    return np.asarray(np.where(used, batch.weights * output / scale, 0.0))


def _features(base: Fit) -> list[tuple[FloatArray, FloatArray]]:
    """Over the operating points (M, n_p) and over the frequencies (K, n_ω) of each batch."""
    batches = base.rows.batches
    ends = np.array([batch.band for batch in batches])
    low, high = np.log(ends[:, 0].min()), np.log(ends[:, 1].max())
    lines = max(int(np.max(np.sum(batch.classes == EXCITED, axis=1))) for batch in batches)
    nodes = np.linspace(low, high, int(np.clip(lines // 3, 2, NODES)))[:, None]
    width = max(WIDTH * float(nodes[-1, 0] - nodes[0, 0]), 1e-9)
    points = _spread_points(np.unique(np.concatenate([flow.setting.points for flow in base.flows]), axis=0))
    found = []
    for batch, flow in zip(batches, base.flows, strict=True):
        logarithm = np.log(np.maximum(batch.omega, 1e-300))[:, None]
        at_points = _of_channels(batch, _kernel(flow.setting.points, points, 1.0))
        found.append((at_points, _kernel(logarithm, nodes, width)))
    return found


def _of_channels(batch: Batch, at_points: FloatArray) -> FloatArray:
    """Features of rows (M, n), those of every path of their own: what is missing there says nothing of the others."""
    if batch.ports is None:
        return at_points
    of_path = np.eye(batch.shape[0] * batch.shape[1])[batch.ports @ np.array([batch.shape[1], 1])]
    return np.asarray((at_points[:, :, None] * of_path[:, None, :]).reshape(len(at_points), -1))


def _spread_points(points: FloatArray) -> FloatArray:
    """Up to `POINT_NODES` of the points (n, s), each as far from those before as can be."""
    chosen = [0]
    while len(chosen) < min(POINT_NODES, len(points)):
        distance = np.min(np.sum((points[:, None] - points[chosen]) ** 2, axis=-1), axis=1)
        chosen.append(int(np.argmax(distance)))
    return points[chosen]


def _kernel(at: FloatArray, nodes: FloatArray, width: float) -> FloatArray:
    """K_xz K_zz^{−½} of the Matérn covariance 3/2 of this width, (n, nodes)."""

    def of(x: FloatArray) -> FloatArray:
        distance = np.sqrt(3 * np.sum((x[:, None] - nodes) ** 2, axis=-1)) / width
        return np.asarray((1 + distance) * np.exp(-distance))

    values, vectors = np.linalg.eigh(of(nodes))
    kept = values > 1e-10 * values[-1]
    return np.asarray(of(at) @ (vectors[:, kept] / np.sqrt(values[kept])) @ vectors[:, kept].T)


class _Likelihood:
    """−2 ln of the restricted likelihood of a fit over τ and κ, from the Gram matrices of tangents and residual."""

    def __init__(self, model: SmoothRemainder, found: Fit) -> None:
        self.model = model
        size = np.linalg.norm(found.tangents, axis=1)
        kept = found.tangents[size > 0] / size[size > 0, None]
        rows = np.concatenate([kept, found.residual[None]])
        self.k, self.count, self.scaled = len(kept), found.rows.count, found.rows.scaled
        self.grams = [rows[:, c] @ rows[:, c].T if c.any() else np.zeros((len(rows),) * 2) for c in model.classes]
        self.sizes = [int(c.sum()) for c in model.classes]
        self.onto = model.onto(rows)
        self.most = self._most(found)

    def _most(self, found: Fit) -> FloatArray:
        """κ of each class of unexcited lines at which it holds the material share of the output."""
        batches, flows = found.rows.batches, found.flows
        output = sum(float(np.sum(abs(batch.outputs[batch.classes == EXCITED]) ** 2)) for batch in batches)
        result = []
        for number in range(1, len(CLASS_NAMES)):
            noise = 0.0
            for batch, _ in zip(batches, flows, strict=True):
                used = (batch.classes == number) & np.isfinite(batch.variances)
                noise += float(np.sum(batch.variances[used]))
            result.append(self.model.material**2 * output / noise if noise > 0 else 0.0)
        return np.array(result)

    @property
    def other(self) -> list[int]:
        """Classes of unexcited lines that there are."""
        return [i for i in range(1, len(self.sizes)) if self.sizes[i]]

    def _gram(self, tau: float, kappa: FloatArray) -> FloatArray:
        shrink = tau**2 / (1 + tau**2 * self.model.values)
        total = self.grams[0] - (self.onto.conj() * shrink @ self.onto.T).real
        for i in self.other:
            total = total + self.grams[i] / (1 + kappa[i - 1])
        return np.asarray(total)

    def at(self, tau: float, kappa: FloatArray) -> tuple[float, FloatArray]:
        """−2 ln L (up to a constant) and the weights of (tangents, residual) in the whitened residual."""
        gram = self._gram(tau, kappa)
        inner = gram[: self.k, : self.k] + 1e-12 * np.eye(self.k)
        weights = np.linalg.solve(inner, gram[: self.k, -1]) if self.k else np.zeros(0)
        left = max(float(gram[-1, -1] - weights @ gram[: self.k, -1]), np.finfo(float).tiny)
        value = 2 * float(np.sum(np.log1p(tau**2 * self.model.values)))
        value += sum(self.sizes[i] * float(np.log1p(kappa[i - 1])) for i in self.other)
        value += float(np.linalg.slogdet(inner)[1]) if self.k else 0.0
        freedom = self.count - self.k
        value += left if self.scaled else freedom * float(np.log(left / freedom))
        return value, np.append(-weights, 1.0)

    def _excess(self, i: int, weights: FloatArray, noise: float) -> float:
        energy = float(weights @ self.grams[i] @ weights)
        expected = self.sizes[i] * (1 - self.k / self.count)
        return max(energy / max(expected * noise, 1e-300) - 1, 0.0)

    def _best(self, sizes: FloatArray, most: FloatArray) -> tuple[float, float, FloatArray]:
        kappa = np.zeros(len(self.grams) - 1)
        tau = 0.0
        for _ in range(ROUNDS):
            tau = float(sizes[int(np.argmin([self.at(float(size), kappa)[0] for size in sizes]))])
            weights = self.at(tau, kappa)[1]
            for i in self.other:
                kappa[i - 1] = min(self._excess(i, weights, self._noise(tau, kappa)), most[i - 1])
        return self.at(tau, kappa)[0], tau, kappa

    def _noise(self, tau: float, kappa: FloatArray) -> float:
        if self.scaled:
            return 1.0
        gram = self._gram(tau, kappa)
        inner = gram[: self.k, : self.k] + 1e-12 * np.eye(self.k)
        left = gram[-1, -1] - gram[: self.k, -1] @ np.linalg.solve(inner, gram[: self.k, -1])
        return float(max(left, np.finfo(float).tiny)) / (self.count - self.k)

    def maximised(self) -> Remainder:
        inside = SIZES[self.model.material >= SIZES]
        bounded = self._best(inside, self.most)[0]
        value, tau, kappa = self._best(SIZES, np.full(len(self.most), np.inf))
        nothing = np.zeros(len(self.most))
        inner = self._gram(0.0, nothing)[: self.k, : self.k] + 1e-12 * np.eye(self.k)
        reference = float(np.linalg.slogdet(inner)[1]) if self.k else 0.0
        return Remainder(
            cost=value - reference,
            immaterial=min(bounded, self.at(0.0, nothing)[0]) - reference,
            size=tau,
            excess=tuple(kappa[i - 1] for i in self.other),
            noise=self._noise(tau, kappa),
            hyperparameters=1 + len(self.other),
        )

    def tested(self, name: str, generator: np.random.Generator) -> TestResult:
        """The restricted likelihood ratio of τ² = 0 without other lines (responses have none)."""
        none = np.zeros(len(self.most))
        values = np.array([self.at(float(size), none)[0] for size in COARSE])
        ratio = float(values[0] - values.min())
        noise = self._noise(float(COARSE[int(np.argmin(values))]), none)
        freedom = self.count - self.k
        energy = self._noise(0.0, none) * freedom / noise
        null = self._null(generator, freedom)
        p = (1 + float(np.sum(null >= ratio))) / (1 + len(null))
        if p * len(null) < 10:
            p = min(p, 0.5 * float(chdtrc(1, ratio)))
        return TestResult(name, energy, float(freedom), p)

    def _null(self, generator: np.random.Generator, freedom: int) -> FloatArray:
        """Draws of the ratio where there is noise alone, (DRAWS,)."""
        values = np.concatenate([np.diag(self.model.values), np.zeros((len(self.model.values),) * 2)], axis=1)
        values = np.concatenate([values, np.roll(values, len(self.model.values), axis=1)])
        onto = np.concatenate([self.onto[: self.k].real, self.onto[: self.k].imag], axis=1)
        gram = self._gram(0.0, np.zeros(len(self.most)))[: self.k, : self.k] + 1e-12 * np.eye(self.k)
        inside = values - onto.T @ np.linalg.solve(gram, onto) if self.k else values
        spread = np.maximum(np.linalg.eigvalsh(inside), 0.0)
        squares = generator.chisquare(1, (DRAWS, len(spread)))
        others = generator.chisquare(max(freedom - len(spread), 1), DRAWS)
        total = squares.sum(axis=1) + others
        best = np.zeros(DRAWS)
        for size in COARSE[1:]:
            factor = 1 + size**2 * spread
            left = squares @ (1 / factor) + others
            best = np.maximum(best, freedom * np.log(total / left) - np.sum(np.log(factor)))
        return best
