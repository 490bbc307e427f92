"""The loop of a batch on the finer time grid of its forces, with all lines that this grid holds."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from identification.arrays import ComplexArray
from identification.comparison.batch import Batch
from identification.models.hold import hold_factor
from identification.places.core import core_response
from identification.places.loop import Loop
from identification.places.place import Effect, Setting

LEAST = 4


@dataclass(frozen=True, eq=False)
class FineGrid:
    """Signals of period L on a grid of L n steps: forces that jump are not cut off at Nyquist's frequency in the loop.

    What the samples of a signal show of lines beyond it is folded back [PintelonSchoukens2012, Section 2.2].
    """

    batch: Batch
    n: int

    def of(self, lines: ComplexArray) -> ComplexArray:
        """Lines (M, K) among those of the fine grid (M, K_f), the others zero."""
        found = np.zeros((len(lines), self._length // 2 + 1), dtype=np.complex128)
        found[:, : lines.shape[1]] = lines * np.where(self.batch.real & (self.batch.omega > 0), 0.5, 1.0)
        return found

    def sampled(self, lines: ComplexArray) -> ComplexArray:
        """Lines (M, K) of the samples of signals with lines (M, K_f)."""
        length = self._length
        signal = np.fft.irfft(lines * length, n=length)[:, :: self.n]
        return np.asarray(np.fft.rfft(signal)[:, : len(self.batch.omega)] / signal.shape[1])

    @property
    def _length(self) -> int:
        assert self.batch.signals is not None
        return int(self.batch.signals.shape[1]) * self.n

    def loop(self, coarse: Loop, setting: Setting, acting: Sequence[tuple[Effect, np.ndarray]]) -> Loop:
        """The loop with the input as it is between the samples."""
        length, step = self._length, (self.batch.sample_time or 1.0) / self.n
        omega = np.asarray(2 * np.pi * np.fft.rfftfreq(length, step))
        entering = self.of(coarse.entering)
        if self.batch.held is not None:
            entering = self._images(coarse.entering) * hold_factor(omega, self.batch.held)
        fine = Batch(
            self.batch.points,
            omega,
            entering,
            entering,
            np.ones(entering.shape),
            np.zeros(entering.shape, dtype=np.int64),
            self.batch.members,
            np.zeros((len(entering), length)),
            step,
            channels=self.batch.channels,
        )
        response = core_response(setting, acting, omega)
        return Loop(response, response, entering, coarse.forces, fine, 1, None, setting)

    def _images(self, lines: ComplexArray) -> ComplexArray:
        """Lines of samples (M, K) at all frequencies, (M, K_f)."""
        assert self.batch.signals is not None
        length = self.batch.signals.shape[1]
        every = np.fft.fft(np.fft.irfft(lines * length, n=length)) / length
        return np.asarray(np.tile(every, self.n // 2 + 1)[:, : self._length // 2 + 1])


def fine_grid(loop: Loop, setting: Setting) -> FineGrid | None:
    """The grid of forces that jump, of plants in continuous time in a steady state; None where there are none."""
    jumps = loop.finer >= LEAST and loop.between is None and loop.batch.repeats
    known = loop.batch.sample_time is not None and not setting.structure.is_discrete
    return FineGrid(loop.batch, loop.finer) if jumps and known and loop.forces else None
