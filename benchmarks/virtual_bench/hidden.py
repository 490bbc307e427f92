"""What the bench may hide, written as differential equations and time functions; strength 0 hides nothing."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

DURATION = 25.6


def _nothing(x, v, z):
    return 0.0 * x


def _still(x, v, z, e):
    return 0.0 * x


@dataclass(frozen=True)
class Hidden:
    """One hidden effect: `guess` a strength to begin the calibration with; `truth` the kind in the library."""

    guess: float
    force: Callable = _nothing
    memory: Callable = _still
    actuate: Callable | None = None
    sense: Callable | None = None
    change: Callable | None = None
    mode: Callable | None = None

    def actuator(self, u, e, done):
        """The input on the half-step grid as the plant sees it."""
        return u if self.actuate is None else self.actuate(u, e, done)

    def output(self, y, e, done, inputs):
        """The output at the samples as the sensor shows it."""
        if self.mode is not None:
            y = y + e * driven(self.mode, inputs, y.shape[1])
        return y if self.sense is None else self.sense(y, e, done)

    def coefficients(self, k, c, b, e, p):
        """Stiffness, damping and gain as they really are."""
        return (k, c, b) if self.change is None else self.change(k, c, b, e, p)


def driven(response, inputs, samples):
    """The steady answer at the samples of a mode that is driven by what the actuator passes on."""
    lines = np.arange(inputs.shape[1] // 2 + 1)
    spectrum = np.fft.rfft(inputs) * response(2 * np.pi * lines / DURATION)
    return np.fft.irfft(spectrum, n=inputs.shape[1])[:, :: inputs.shape[1] // samples]


def linear_path(response):
    """A path from input to output beside the plant, by its response at the lines of the input."""

    def sense(y, e, done):
        omega = 2 * np.pi * done.lines / DURATION
        t = np.arange(y.shape[1]) * DURATION / y.shape[1]
        waves = np.exp(1j * np.outer(omega, t))
        return y + e * np.real((done.phasors * response(omega)) @ waves)

    return sense


def linear_filter(response):
    """A filter of the input ahead of the plant, by its response (ω, e) at the lines of the input."""

    def actuate(u, e, done):
        omega = 2 * np.pi * done.lines / DURATION
        grid = u.shape[1]
        spectrum = np.zeros((len(u), grid // 2 + 1), dtype=complex)
        spectrum[:, done.lines] = done.phasors * response(omega, e)
        return np.fft.irfft(spectrum * grid / 2, n=grid)

    return actuate


def played(width):
    """Play of ± width, followed sample by sample over two periods."""

    def actuate(u, e, done):
        z, out = np.zeros(len(u)), np.empty_like(u)
        for i in range(2 * u.shape[1]):
            now = u[:, i % u.shape[1]]
            z = np.minimum(np.maximum(z, now - width), now + width)
            out[:, i % u.shape[1]] = z
        return u + e * (out - u)

    return actuate


def _rms(x):
    return np.sqrt(np.mean(x**2))


def _clip(x, level):
    return np.minimum(np.maximum(x, -level), level)


def _ramp(y, e, done):
    return y + e * (np.arange(y.shape[1]) / y.shape[1] - 0.5)


def _hum(y, e, done):
    t = np.arange(y.shape[1]) / y.shape[1]
    return y + e * np.cos(2 * np.pi * _free_line(done) * t + 0.7)


def _free_line(done):
    return next(k for k in range(20, 99) if k not in set(done.lines.tolist()))


def _misplaced(k, c, b, e, p):
    return k + 28.0 * e * (abs(p - p[len(p) // 2]) < 1e-9), c, b


def _temperature(done_points):
    return np.sin(7.0 * np.arange(len(done_points)))


HIDDEN = {
    "delay": Hidden(0.01, actuate=linear_filter(lambda w, e: np.exp(-1j * w * e))),
    "lag": Hidden(0.01, actuate=linear_filter(lambda w, e: 1 / (1 + 1j * w * e))),
    "lead": Hidden(0.01, actuate=linear_filter(lambda w, e: 1 + 1j * w * e)),
    "resonance": Hidden(0.05, mode=lambda w: 1 / (14.0**2 - w**2 + 0.1j * 14.0 * w)),
    "antiresonance": Hidden(
        0.2, actuate=linear_filter(lambda w, e: 1 - e * 0.3j * 7.0 * w / (49.0 - w**2 + 0.3j * 7.0 * w))
    ),
    "integrator": Hidden(1e-3, sense=linear_path(lambda w: 1 / (1j * w))),
    "leak": Hidden(0.05, actuate=linear_filter(lambda w, e: 1j * w / (1j * w + e))),
    "feedthrough": Hidden(1e-3, sense=linear_path(lambda w: np.ones_like(w))),
    "warburg": Hidden(1e-3, sense=linear_path(lambda w: (1j * w) ** -0.5)),
    "warburg_open": Hidden(1e-3, sense=linear_path(lambda w: 1 / (np.sqrt(0.5j * w) * np.tanh(np.sqrt(0.5j * w))))),
    "warburg_short": Hidden(1e-3, sense=linear_path(lambda w: np.tanh(np.sqrt(0.8j * w)) / np.sqrt(0.8j * w))),
    "inductance": Hidden(1e-4, sense=linear_path(lambda w: 1j * w)),
    "lossy_inductance": Hidden(1e-4, sense=linear_path(lambda w: (1j * w) ** 0.6)),
    "rc_arc": Hidden(1e-3, sense=linear_path(lambda w: 1 / (1 + 0.3j * w))),
    "cpe_arc": Hidden(1e-3, sense=linear_path(lambda w: 1 / (1 + (0.6j * w) ** 0.7))),
    "time_base": Hidden(
        0.01,
        change=lambda k, c, b, e, p: (k / (1 + e) ** 2, c / (1 + e), b / (1 + e) ** 2),
    ),
    "quadratic_dependence": Hidden(3.0, change=lambda k, c, b, e, p: (k + e * (1.5 * p**2 - 0.5), c, b)),
    "cubic_dependence": Hidden(3.0, change=lambda k, c, b, e, p: (k + e * (2.5 * p**3 - 1.5 * p), c, b)),
    "misplaced_point": Hidden(0.1, change=_misplaced),
    "second_variable": Hidden(2.0, change=lambda k, c, b, e, p: (k + e * _temperature(p), c, b)),
    "gain_drift": Hidden(0.2, change=lambda k, c, b, e, p: (k, c, b * (1 + e * (np.arange(len(p)) / 100 - 0.5)))),
    "coulomb_friction": Hidden(1.0, force=lambda x, v, z: np.tanh(v / 0.004)),
    "quadratic_damping": Hidden(0.3, force=lambda x, v, z: abs(v) * v),
    "cubic_damping": Hidden(0.2, force=lambda x, v, z: v**3),
    "quadratic_stiffness": Hidden(10.0, force=lambda x, v, z: x**2),
    "cubic_stiffness": Hidden(20.0, force=lambda x, v, z: x**3),
    "gravity": Hidden(2.0, force=lambda x, v, z: np.sin(2 * np.pi * x / 0.9)),
    "hysteresis": Hidden(2.0, force=lambda x, v, z: z, memory=lambda x, v, z, e: (v - abs(v) * z) / 0.15),
    "dead_band_spring": Hidden(10.0, force=lambda x, v, z: x - _clip(x, 0.45)),
    "quadratic_actuator": Hidden(1e-3, actuate=lambda u, e, done: u + e * u**2),
    "cubic_actuator": Hidden(1e-4, actuate=lambda u, e, done: u + e * u**3),
    "saturation": Hidden(0.5, actuate=lambda u, e, done: u + e * (_clip(u, 28.0) - u)),
    "dead_zone": Hidden(0.5, actuate=lambda u, e, done: u - e * _clip(u, 4.0)),
    "backlash": Hidden(0.5, actuate=played(2.0)),
    "actuator_offset": Hidden(1.0, actuate=lambda u, e, done: u + e),
    "quadratic_sensor": Hidden(0.1, sense=lambda y, e, done: y + e * y**2),
    "cubic_sensor": Hidden(0.1, sense=lambda y, e, done: y + e * y**3),
    "sensor_saturation": Hidden(0.5, sense=lambda y, e, done: y + e * (_clip(y, 0.5) - y)),
    "sensor_dead_zone": Hidden(0.5, sense=lambda y, e, done: y - e * _clip(y, 0.06)),
    "sensor_offset": Hidden(0.01, sense=lambda y, e, done: y + e),
    "drift": Hidden(0.05, sense=_ramp),
    "hum": Hidden(0.02, sense=_hum),
}
