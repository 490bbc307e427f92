"""What the recorder and the sensor do to a linear stage: hold, clock, hum, steps, walks, filters."""

import numpy as np
from scipy.signal import butter, freqs

from benchmarks.campaigns.campaign import Campaign, Truth, campaign
from benchmarks.campaigns.integrator import held, integrate
from benchmarks.campaigns.stage import FITTED, HELD_OUT, PERIOD, PERIODS, SETTLING, Stage, no_law, stage
from identification.arrays import ComplexArray, FloatArray

SAMPLES = PERIOD * PERIODS


class _Recorded:
    """A campaign of a linear stage whose steady outputs are sums of sines; a sensor adds to them record by record."""

    def __init__(self, case: str, truth: Truth, plant: Stage, g: np.random.Generator):
        self.made, self.plant, self.g = campaign(case, truth, plant.said()), plant, g
        shares = np.array([*np.repeat(FITTED, 2), *HELD_OUT])
        self.points = plant.at(shares)
        self.amplitudes, self.lines = plant.multisine(len(shares), g)
        self.omega = plant.frequencies(self.lines)
        self.time = np.asarray(plant.sample_time * np.arange(SAMPLES))

    def sines(self, amplitudes: ComplexArray, time: FloatArray) -> FloatArray:
        return np.asarray(np.real(np.exp(1j * np.multiply.outer(time, self.omega)) @ amplitudes))

    def output(self, e: int, sensor: ComplexArray | float = 1.0, time: FloatArray | None = None) -> FloatArray:
        response = self.plant.response(self.points[e], self.omega) * sensor
        return self.sines(response * self.amplitudes[:, e], self.time if time is None else time)

    def add(self, e: int, y: FloatArray) -> None:
        fitted = e < 8
        u = self.sines(self.amplitudes[:, e], self.time[:PERIOD])
        y = self.plant.noisy(y, self.g) if fitted else y
        self.made.record(self.points[e], u, y, self.plant.sample_time, PERIOD, "fitted" if fitted else "held_out")


def hum(case: str, g: np.random.Generator) -> Campaign:
    """A sine on the sensor that no line of the period meets."""
    one = _Recorded(case, Truth(("hum",), nothing_is_right=True), stage(g), g)
    spacing = 2 * np.pi / (PERIOD * one.plant.sample_time)
    omega = (int(g.integers(5, PERIOD // 3)) + g.uniform(0.2, 0.8)) * spacing
    for e in range(10):
        clean = one.output(e)
        size = g.uniform(0.5, 1.5) * clean.std() * (e < 8)
        one.add(e, clean + size * np.sin(omega * one.time + g.uniform(0, 2 * np.pi)))
    return one.made


def two_hums(case: str, g: np.random.Generator) -> Campaign:
    """Two sines on the sensor, one of them within a fifth of the spacing of an excited line."""
    one = _Recorded(case, Truth(("hum",), nothing_is_right=True), stage(g), g)
    near = g.choice(one.lines) + g.choice([-1, 1]) * g.uniform(0.1, 0.2)
    far = int(g.integers(5, PERIOD // 3)) + g.uniform(0.3, 0.7)
    tones = np.array([near, far]) * 2 * np.pi / (PERIOD * one.plant.sample_time)
    for e in range(10):
        clean = one.output(e)
        sizes = g.uniform(0.1, 0.5, 2) * clean.std() * (e < 8)
        phases = g.uniform(0, 2 * np.pi, 2)
        one.add(e, clean + np.sin(np.multiply.outer(one.time, tones) + phases) @ sizes)
    return one.made


def input_noise(case: str, g: np.random.Generator) -> Campaign:
    """The input is measured with noise of 3 to 20 % of it; the plant lacks nothing."""
    one = _Recorded(case, Truth(("input_noise",), nothing_is_right=True), stage(g, int(g.integers(0, 2))), g)
    size = g.uniform(0.03, 0.2)
    for e in range(10):
        u, y = one.sines(one.amplitudes[:, e], one.time), one.output(e)
        seen = u + size * u.std() * g.standard_normal(len(u)) if e < 8 else u[:PERIOD]
        shown, part = (one.plant.noisy(y, g), "fitted") if e < 8 else (y, "held_out")
        one.made.record(one.points[e], seen, shown, one.plant.sample_time, PERIOD, part)
    return one.made


def clock_skew(case: str, g: np.random.Generator) -> Campaign:
    """The clock of the output runs fast or slow."""
    skew = g.choice([-1, 1]) * 10 ** g.uniform(-4.3, -3.3)
    one = _Recorded(case, Truth(("clock_skew", "time_base")), stage(g), g)
    for e in range(10):
        one.add(e, one.output(e, time=one.time * (1 + skew)))
    return one.made


def random_walk(case: str, g: np.random.Generator) -> Campaign:
    """The level of the sensor walks; the plant lacks nothing."""
    one = _Recorded(case, Truth(nothing_is_right=True), stage(g), g)
    step = 10 ** g.uniform(-3, -1.7)
    for e in range(10):
        clean = one.output(e)
        one.add(e, clean + (e < 8) * step * clean.std() * np.cumsum(g.standard_normal(SAMPLES)))
    return one.made


def quantised(case: str, g: np.random.Generator) -> Campaign:
    """A converter of few steps."""
    one = _Recorded(case, Truth(("quantisation",), nothing_is_right=True), stage(g), g)
    step = one.output(0).std() * g.uniform(0.1, 0.6)
    for e in range(10):
        clean = one.output(e)
        one.made.record(
            one.points[e],
            one.sines(one.amplitudes[:, e], one.time[:PERIOD]),
            step * np.round((clean + 0.02 * step * g.standard_normal(SAMPLES)) / step) if e < 8 else clean,
            one.plant.sample_time,
            PERIOD,
            "fitted" if e < 8 else "held_out",
        )
    return one.made


def jitter(case: str, g: np.random.Generator) -> Campaign:
    """Sampling instants that scatter; the plant lacks nothing."""
    one = _Recorded(case, Truth(("jitter",), nothing_is_right=True), stage(g), g)
    size = g.uniform(0.02, 0.1) * one.plant.sample_time
    for e in range(10):
        one.add(e, one.output(e, time=one.time + (e < 8) * size * g.standard_normal(SAMPLES)))
    return one.made


def nothing_periodic(case: str, g: np.random.Generator) -> Campaign:
    """Nothing is hidden, any sensor."""
    one = _Recorded(case, Truth(nothing_is_right=True), stage(g, int(g.integers(0, 3))), g)
    for e in range(10):
        one.add(e, one.output(e))
    return one.made


def antialias_filter(case: str, g: np.random.Generator) -> Campaign:
    """A Butterworth low-pass in the sensor, seen as a delay or a lag."""
    one = _Recorded(case, Truth(("delay", "lag")), stage(g), g)
    corner = g.uniform(2.5, 6) * np.sqrt(one.plant.stiffness / one.plant.mass)
    _, sensor = freqs(*butter(int(g.integers(2, 6)), corner, analog=True), worN=one.omega)
    for e in range(10):
        one.add(e, one.output(e, sensor))
    return one.made


def delay(case: str, g: np.random.Generator) -> Campaign:
    """A dead time of a fraction of a sample to several turns over the band."""
    one = _Recorded(case, Truth(("delay",)), stage(g), g)
    late = 10 ** g.uniform(-0.5, 1.5) * one.plant.sample_time
    for e in range(10):
        one.add(e, one.output(e, np.exp(-1j * one.omega * late)))
    return one.made


def zero_order_hold(case: str, g: np.random.Generator) -> Campaign:
    """The input is held between samples, which nobody says."""
    plant = stage(g)
    one = _Recorded(case, Truth(("input_hold",)), plant, g)
    one.made.entry["input_between_samples"] = None
    u = one.sines(one.amplitudes, one.time[:PERIOD])
    drive = np.tile(held(u), (SETTLING + 1, 1, 1))
    states = integrate(plant.slope(one.points, no_law), np.zeros((2, 10)), drive, plant.sample_time)
    for e in range(10):
        one.add(e, np.tile(states[-PERIOD:, 0, e], PERIODS))
    return one.made
