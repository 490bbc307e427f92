"""A stage m q″ + d q′ + (k₀ + k₁ p) q + f(q, q′) = F whose position, speed or acceleration is measured."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.signal import cont2discrete

from benchmarks.campaigns.campaign import Campaign, Truth, campaign
from benchmarks.campaigns.integrator import band_limited, integrate
from identification.arrays import ComplexArray, FloatArray

Law = Callable[[FloatArray, FloatArray], FloatArray]
PERIOD, PERIODS, SETTLING = 512, 4, 2
QUANTITIES = (("position", "m"), ("velocity", "m/s"), ("acceleration", "m/s^2"))
FITTED, HELD_OUT = (0.0, 1 / 3, 2 / 3, 1.0), (0.17, 0.79)


def no_law(q: FloatArray, v: FloatArray) -> FloatArray:
    """Nothing is hidden."""
    return 0 * q


@dataclass(frozen=True)
class Stage:
    """The plant, its sensor of `order` 0, 1 or 2, and its recorder; p runs from 0 to `travel`."""

    mass: float
    damping: float
    stiffness: float
    softer: float
    travel: float
    order: int
    sample_time: float
    noise: float

    def at(self, share: float | FloatArray) -> FloatArray:
        """The operating point at a share of the travel."""
        return np.asarray(self.travel * np.asarray(share))

    def spring(self, p: FloatArray) -> FloatArray:
        """k(p)."""
        return np.asarray(self.stiffness * (1 - self.softer * np.asarray(p) / self.travel))

    def response(self, p: float, omega: FloatArray, spring: float | None = None) -> ComplexArray:
        """The output over the force at frequencies (K,)."""
        s = 1j * omega
        k = float(self.spring(np.asarray(p))) if spring is None else spring
        return np.asarray(s**self.order / (self.mass * s**2 + self.damping * s + k))

    @property
    def scale(self) -> float:
        """A round frequency near the resonance."""
        return float(f"{np.sqrt(self.stiffness / self.mass):.1g}")

    def said(self) -> dict[str, Any]:
        """What a user says of it: a model in continuous time whose stiffness is linear in p."""
        w, m = self.scale, self.mass
        a = [
            self.damping / (m * w),
            self.stiffness / (m * w**2),
            -self.softer * self.stiffness / (self.travel * m * w**2),
        ]
        b = [w ** (self.order - 2) / m] + [0.0] * self.order
        return self._signals() | {
            "structure": {"n_a": 2, "n_b": self.order, "n_k": 0, "sample_time": None, "frequency_scale": w},
            "polynomial_degrees": [0, 1] + [0] * len(b),
            "theta_start": [*a, *b],
        }

    def said_sampled(self) -> dict[str, Any]:
        """What a user says of it with a held input: a sampled model, all coefficients linear in p."""
        ends = []
        for p in (0.0, self.travel):
            k = float(self.spring(np.asarray(p)))
            a = np.array([[0, 1], [-k / self.mass, -self.damping / self.mass]])
            c = [[1.0, 0.0], [0.0, 1.0], a[1].tolist()][self.order]
            continuous = (a, np.array([[0], [1 / self.mass]]), np.array([c]), np.array([[self.order == 2]]) / self.mass)
            sampled = cont2discrete(continuous, self.sample_time)
            poles = np.poly(sampled[0])
            zeros = np.poly(sampled[0] - sampled[1] @ sampled[2]) + (sampled[3][0, 0] - 1) * poles
            ends.append(np.concatenate([poles[1:], zeros[1:]]))
        slopes = (ends[1] - ends[0]) / self.travel
        return self._signals() | {
            "input_between_samples": "zero_order_hold",
            "structure": {"n_a": 2, "n_b": 1, "n_k": 1, "sample_time": self.sample_time, "frequency_scale": 1.0},
            "polynomial_degrees": [1] * 4,
            "theta_start": np.stack([ends[0], slopes], axis=1).ravel().tolist(),
        }

    def _signals(self) -> dict[str, Any]:
        quantity, unit = QUANTITIES[self.order]
        return {
            "input": {"quantity": "force", "unit": "N"},
            "output": {"quantity": quantity, "unit": unit},
            "scheduling": {"name": "position", "unit": "m", "minimum": 0.0, "maximum": self.travel},
        }

    def slope(self, p: FloatArray, law: Law, spring: Callable[[float], FloatArray] | None = None) -> Any:
        """The derivative of the states (q, q′)."""
        fixed = self.spring(p)

        def derivative(x: FloatArray, force: FloatArray, t: float) -> FloatArray:
            k = fixed if spring is None else spring(t)
            return np.stack([x[1], (force - self.damping * x[1] - k * x[0] - law(x[0], x[1])) / self.mass])

        return derivative

    def measured(self, states: FloatArray, force: FloatArray, p: FloatArray, law: Law) -> FloatArray:
        """The output (N, E) of states (N, 2, E) under forces (N, E)."""
        if self.order < 2:
            return states[:, self.order]
        return np.stack([self.slope(p, law)(x, u, 0.0)[1] for x, u in zip(states, force, strict=True)])

    def multisine(self, count: int, g: np.random.Generator) -> tuple[ComplexArray, np.ndarray]:
        """Amplitudes (K, count) of about 1 N rms up to twice the resonance, and their lines."""
        top = int(2 * np.sqrt(self.stiffness / self.mass) / (2 * np.pi) * PERIOD * self.sample_time)
        lines = np.arange(1, min(top, PERIOD // 3), int(g.integers(1, 3)))
        return np.sqrt(2 / len(lines)) * np.exp(2j * np.pi * g.random((len(lines), count))), lines

    def frequencies(self, lines: np.ndarray) -> FloatArray:
        """The frequencies of lines in rad/s."""
        return np.asarray(2 * np.pi * lines / (PERIOD * self.sample_time), dtype=np.float64)

    def motion(self, amplitudes: ComplexArray, lines: np.ndarray) -> tuple[float, float]:
        """The rms of displacement and speed that the linear plant has in the middle of its travel."""
        omega = self.frequencies(lines)
        q = self.response(self.travel / 2, omega)[:, None] / ((1j * omega) ** self.order)[:, None] * amplitudes
        return tuple(float(np.sqrt(np.mean(np.sum(abs(x) ** 2, axis=0) / 2))) for x in (q, 1j * omega[:, None] * q))

    def steady(
        self, p: FloatArray, amplitudes: ComplexArray, lines: np.ndarray, law: Law
    ) -> tuple[FloatArray, FloatArray]:
        """Input and output (PERIOD, E) over the period after SETTLING others."""
        force = band_limited(amplitudes, lines, PERIOD)
        states = integrate(
            self.slope(p, law), np.zeros((2, len(p))), np.tile(force, (SETTLING + 1, 1, 1)), self.sample_time
        )
        u = force[:, 0]
        return u, self.measured(states[-PERIOD:], u, p, law)

    def noisy(self, y: FloatArray, g: np.random.Generator) -> FloatArray:
        """The output (N,) with white noise."""
        return np.asarray(y + self.noise * y.std() * g.standard_normal(len(y)))


def stage(g: np.random.Generator, order: int = 0) -> Stage:
    """A stage of random size: resonance between 3 and 12 Hz, 3 to 15 % damped, noise of 0.2 to 2 %."""
    resonance, mass = 2 * np.pi * g.uniform(3, 12), 10 ** g.uniform(-0.5, 0.8)
    damping = 2 * g.uniform(0.03, 0.15) * mass * resonance
    noise = 10 ** g.uniform(-2.7, -1.7)
    travel = float(g.choice([0.1, 0.5, 1.0, 2.0]))
    return Stage(
        mass, damping, mass * resonance**2, g.uniform(0.2, 0.5), travel, order, g.uniform(0.25, 0.5) / resonance, noise
    )


def played(
    case: str,
    truth: Truth,
    plant: Stage,
    g: np.random.Generator,
    law: Callable[[float, float], Law] = lambda q, v: no_law,
    loudness: float = 1.0,
    periods: tuple[int, ...] = (PERIODS,),
) -> Campaign:
    """Multisines at four points, two records each, and at two held out; `law` is made from the rms of q and q′."""
    shares = np.array([*np.repeat(FITTED, 2), *HELD_OUT])
    amplitudes, lines = plant.multisine(len(shares), g)
    amplitudes = loudness * amplitudes
    p = plant.at(shares)
    hidden = law(*plant.motion(amplitudes, lines))
    u, y = plant.steady(p, amplitudes, lines, hidden)
    made = campaign(case, truth, plant.said())
    for e, point in enumerate(p):
        count = periods[e % len(periods)]
        tiled = np.tile(y[:, e], count)
        fitted = e < 8
        made.record(
            point,
            u[:, e],
            plant.noisy(tiled, g) if fitted else tiled,
            plant.sample_time,
            PERIOD,
            "fitted" if fitted else "held_out",
        )
    return made
