"""A mass on a spring whose stiffness depends on p, with something hidden in it, and a store that empties.

Both are integrated by Runge–Kutta.
"""

from dataclasses import dataclass, field

import numpy as np

from benchmarks.virtual_bench.hidden import HIDDEN
from identification.signals import TimeRecord

PERIOD, STEPS = 512, 4
SAMPLE_TIME = 0.05
HIGHEST_LINE = 100
DAMPING = 1.8


def stiffness(p):
    """What the model knows: k(p) = 64 + 28 p for p = −1 … 1."""
    return 64.0 + 28.0 * p


def rate(p):
    """What the model of the first order knows: a(p) = 3 + 1.4 p."""
    return 3.0 + 1.4 * p


@dataclass
class Experiments:
    """Operating points (M,) and inputs on the half-step grid of one period (M, 2·STEPS·PERIOD), with derivatives."""

    points: np.ndarray
    inputs: np.ndarray
    rates: np.ndarray
    phasors: np.ndarray
    lines: np.ndarray


def experiments(generator, points=7, levels=(20.0, 10.0)):
    """Random-phase multisines, three quarters of the lines up to HIGHEST_LINE, at each point at each level (rms)."""
    where = np.repeat(np.linspace(-1, 1, points), len(levels))
    lines = np.sort(generator.choice(np.arange(1, HIGHEST_LINE + 1), 3 * HIGHEST_LINE // 4, replace=False))
    phases = generator.uniform(0, 2 * np.pi, (len(where), len(lines)))
    amplitude = np.tile(levels, points) * np.sqrt(2 / len(lines))
    phasors = amplitude[:, None] * np.exp(1j * phases)
    return Experiments(where, *on_half_steps(phasors, lines), phasors, lines)


def on_half_steps(phasors, lines):
    """Inputs and their derivatives on the half-step grid of one period, from the phasors of the lines."""
    grid = 2 * STEPS * PERIOD
    omega = 2 * np.pi * lines / (PERIOD * SAMPLE_TIME)
    spectrum = np.zeros((2, len(phasors), grid // 2 + 1), dtype=complex)
    spectrum[0][:, lines] = phasors
    spectrum[1][:, lines] = phasors * 1j * omega
    return np.fft.irfft(spectrum * grid / 2, n=grid)


@dataclass
class Bench:
    """The bench with hidden effects of some strength; several may be hidden at once."""

    hidden: tuple[tuple[str, float], ...] = field(default=())

    def steady(self, done: Experiments, periods: int = 2) -> np.ndarray:
        """One noise-free period of the output, (M, PERIOD), after `periods` − 1 periods of settling."""
        parts = [(HIDDEN[name], strength) for name, strength in self.hidden]
        k, c, b = stiffness(done.points), np.full(len(done.points), DAMPING), np.ones(len(done.points))
        u = done.inputs
        for hidden, strength in parts:
            k, c, b = hidden.coefficients(k, c, b, strength, done.points)
            u = hidden.actuator(u, strength, done)

        def slope(s, i):
            x, v = s[0], s[1]
            force = b * u[:, i] - k * x - c * v
            extra = []
            for (hidden, strength), z in zip(parts, s[2:], strict=True):
                force = force - strength * hidden.force(x, v, z)
                extra.append(hidden.memory(x, v, z, strength))
            return [v, force, *extra]

        y = _recorded(slope, [0.0 * k for _ in range(2 + len(parts))], periods)
        for hidden, strength in parts:
            y = hidden.output(y, strength, done, u)
        return y


@dataclass
class FirstOrderBench:
    """A store that empties at a rate which depends on p, x′ = u − a(p) x, with nothing hidden."""

    def steady(self, done: Experiments, periods: int = 2) -> np.ndarray:
        """One noise-free period of the output, (M, PERIOD)."""
        a = rate(done.points)
        return _recorded(lambda s, i: [done.inputs[:, i] - a * s[0]], [0.0 * a], periods)


def _recorded(slope, state, periods):
    """The first state at the samples of the last of `periods` periods, by Runge–Kutta's method of fourth order."""
    h, grid, recorded = SAMPLE_TIME / STEPS, 2 * STEPS * PERIOD, []
    for n in range(periods * PERIOD * STEPS):
        i = 2 * n % grid
        if n >= (periods - 1) * PERIOD * STEPS and n % STEPS == 0:
            recorded.append(state[0])
        k1 = slope(state, i)
        k2 = slope([s + h / 2 * d for s, d in zip(state, k1, strict=True)], i + 1)
        k3 = slope([s + h / 2 * d for s, d in zip(state, k2, strict=True)], i + 1)
        k4 = slope([s + h * d for s, d in zip(state, k3, strict=True)], (i + 2) % grid)
        state = [s + h / 6 * (a + 2 * p + 2 * q + d) for s, a, p, q, d in zip(state, k1, k2, k3, k4, strict=True)]
    return np.stack(recorded, axis=1)


def noisy(y, done: Experiments, share, generator, periods=4, colour=0.0, heavy=False, spread=1.0):
    """Records of `periods` periods: noise of `share` of the rms of each output, AR(1) with pole `colour`.

    `heavy`: Student's t with three degrees of freedom; `spread`: the noise grows by this factor over p.
    """
    records = []
    for m, one in enumerate(y):
        count = periods * PERIOD
        raw = generator.standard_t(3, count + 200) if heavy else generator.standard_normal(count + 200)
        noise = np.empty(count + 200)
        last = 0.0
        for t, value in enumerate(raw):
            last = noise[t] = colour * last + value
        noise = noise[200:] / np.std(noise)
        level = share * np.sqrt(np.mean(one**2)) * spread ** ((done.points[m] + 1) / 2)
        u = np.tile(done.inputs[m, :: 2 * STEPS], periods)
        output = np.tile(one, periods) + level * noise
        records.append(TimeRecord(u, output, SAMPLE_TIME, (float(done.points[m]),), PERIOD))
    return records
