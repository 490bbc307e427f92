"""Numerical solutions of the channel's differential equations, to hold its transfer function against."""

from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp
from scipy.linalg import lu_factor, lu_solve

from examples.open_channel import GRAVITY, OpenChannel
from identification.arrays import ComplexArray, FloatArray


def integrated_response(channel: OpenChannel, positions: FloatArray, omega: float) -> ComplexArray:
    """[G_e, G_s] at positions (X,) and one ω in rad/s, as (X, 2), by integrating the linear equations along x.

        d/dx [q; h] = [0, −B₀ s; −(s − β)/((c₀² − V₀²) B₀), (2V₀B₀ s + γ)/((c₀² − V₀²) B₀)] [q; h],   s = jω

    from x = 0 twice, and combined for q(0) = 1, q(L) = 0 and for q(0) = 0, q(L) = 1.
    """
    s, width = 1j * omega, channel.surface_width
    beta, gamma = channel.friction
    leading = (channel.celerity**2 - channel.velocity**2) * width
    slope = np.array([[0, -width * s], [-(s - beta) / leading, (2 * channel.velocity * width * s + gamma) / leading]])
    ends = (0.0, channel.length)
    at, places = np.unique(np.append(positions, channel.length), return_inverse=True)
    runs = [
        solve_ivp(lambda _, state: slope @ state, ends, start, "DOP853", at, rtol=1e-11, atol=1e-14).y
        for start in (np.array([1 + 0j, 0]), np.array([0j, 1]))
    ]
    runs = [run[:, places] for run in runs]
    flows = [run[0, -1] for run in runs]
    levels = [run[1, :-1] for run in runs]
    entering = levels[0] - flows[0] / flows[1] * levels[1]
    return np.stack([entering, levels[1] / flows[1]], axis=1)


@dataclass(frozen=True)
class TimeStepping:
    """The nonlinear Saint-Venant equations by the implicit box scheme, second order in space and time.

        ∂A/∂t + ∂Q/∂x = 0,   ∂Q/∂t + ∂(Q²/A)/∂x + g A (∂y/∂x + S_f − S) = 0,   S_f = Q |Q| P^{4/3} / (K² A^{10/3})

    Nothing is taken from the linearisation but the uniform flow that the run starts from.
    """

    channel: OpenChannel
    cells: int = 200
    steps_per_period: int = 200
    periods: int = 4

    def response(self, omega: float, entering: bool, amplitude: float = 1e-3) -> ComplexArray:
        """h(x)/q at one ω in rad/s at the `cells` + 1 nodes, for a small sine of the entering or the leaving discharge.

        `amplitude` is relative to Q₀; the first harmonic of the last period is taken.
        """
        channel, nodes = self.channel, self.cells + 1
        step = 2 * np.pi / omega / self.steps_per_period
        state = np.concatenate([np.full(nodes, channel.depth), np.full(nodes, channel.discharge)])
        factor = lu_factor(self._jacobian(state, step))
        levels = []
        for k in range(1, self.periods * self.steps_per_period + 1):
            wave = amplitude * channel.discharge * np.sin(omega * k * step)
            ends = channel.discharge + wave * np.array([entering, not entering])
            new = state.copy()
            for _ in range(4):
                new -= lu_solve(factor, self._residual(new, state, ends, step))
            state = new
            levels.append(state[:nodes])
        last = np.array(levels[-self.steps_per_period :])
        phases = np.exp(-1j * omega * step * np.arange(len(levels) - self.steps_per_period + 1, len(levels) + 1))
        harmonic = 2 / self.steps_per_period * phases @ last
        return np.asarray(harmonic / (-1j * amplitude * channel.discharge))

    def _residual(self, new: FloatArray, old: FloatArray, ends: FloatArray, step: float) -> FloatArray:
        channel, nodes = self.channel, self.cells + 1
        y, q = np.stack([old[:nodes], new[:nodes]]), np.stack([old[nodes:], new[nodes:]])
        area = channel.area(y)
        dx = channel.length / self.cells
        friction = q * abs(q) * channel.perimeter(y) ** (4 / 3) / (channel.strickler**2 * area ** (10 / 3))
        force = GRAVITY * _middle(area) * (_slope(y, dx) + _middle(friction) - channel.bed_slope)
        mass = (_middle(area)[1] - _middle(area)[0]) / step + _slope(q, dx).mean(axis=0)
        momentum = (_middle(q)[1] - _middle(q)[0]) / step + (_slope(q**2 / area, dx) + force).mean(axis=0)
        return np.concatenate([mass, momentum, [q[1, 0] - ends[0], q[1, -1] - ends[1]]])

    def _jacobian(self, state: FloatArray, step: float) -> FloatArray:
        ends = np.full(2, self.channel.discharge)
        base = self._residual(state, state, ends, step)
        columns = []
        for i, value in enumerate(state):
            moved = state.copy()
            moved[i] += 1e-6 * value
            columns.append((self._residual(moved, state, ends, step) - base) / (1e-6 * value))
        return np.stack(columns, axis=1)


def _middle(values: FloatArray) -> FloatArray:
    """Means over the cells of values at the nodes, along the last axis."""
    return (values[:, 1:] + values[:, :-1]) / 2


def _slope(values: FloatArray, dx: float) -> FloatArray:
    """Derivatives over the cells of values at the nodes, along the last axis."""
    return (values[:, 1:] - values[:, :-1]) / dx
