"""Simulation of a model at a constant operating point."""

import numpy as np

from identification.arrays import FloatArray
from identification.errors import MisuseError, ShapeError
from identification.lti.filtering import lfilter
from identification.models.rational import RationalStructure


def simulate(
    structure: RationalStructure,
    zeta: FloatArray,
    input: FloatArray,
    noise: FloatArray | None = None,
    *,
    sample_time: float | None = None,
    periodic: bool = False,
) -> FloatArray:
    """The output y = G u + H e for ζ (n,), u (N,) and the white sequence e (N,), from rest.

    With `periodic` the response to u is the steady state in which u, one period, repeats itself for ever:
    Y(ω_k) = G(ω_k) U(ω_k) on the lines of the record; continuous-time models and delays are simulated only so
    (`sample_time` in seconds is then needed). Raises ShapeError and MisuseError.
    """
    if noise is not None and noise.shape != input.shape:
        raise ShapeError(f"the noise has shape {noise.shape}, the input {input.shape}", "noise")
    if not periodic and (not structure.is_discrete or structure.delay):
        raise MisuseError(
            "only discrete-time models without delay are simulated from rest; use periodic=True", "periodic"
        )
    a, b, _, c, d = (np.asarray(part) for part in structure.split(zeta))
    if periodic:
        output = _steady_state(structure, zeta, input, structure.sample_time or sample_time)
    else:
        output = lfilter(np.concatenate([np.zeros(structure.n_k), b]), np.concatenate([[1.0], a]), input)
    if noise is not None:
        output = output + lfilter(np.concatenate([[1.0], c]), np.concatenate([[1.0], d]), noise)
    return np.asarray(output, dtype=np.float64)


def _steady_state(structure: RationalStructure, zeta: FloatArray, input: FloatArray, step: float | None) -> FloatArray:
    if step is None:
        raise MisuseError("give the sample time of the input of a continuous-time model", "sample_time")
    lines = np.fft.rfft(input)
    omega = 2 * np.pi * np.fft.rfftfreq(len(input), step)
    excited = abs(lines) > 1e-14 * abs(lines).max(initial=0.0)
    lines[excited] *= structure.plant_response(zeta, omega[excited])
    return np.asarray(np.fft.irfft(lines, len(input)))
