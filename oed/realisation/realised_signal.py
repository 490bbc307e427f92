"""What is handed to whoever plays the experiment."""

from dataclasses import dataclass

import numpy as np

from identification.arrays import FloatArray


@dataclass(frozen=True, eq=False)
class RealisedSignal:
    """A signal to play, and what was reached with it.

    `signal` (N,) is one period, played `periods` times (filtered noise does not repeat: one period). The energies
    (N//2 + 1,), per DFT line of the period and in the unit of the signal squared, are those of the whole record: what
    was asked for and what the samples have. Periods that are played beforehand, to let the response of the plant to
    the switching on die away, come in addition and are not counted.

    `crest_factor` is that of the samples; `crest_factor_between_samples` is that of their band-limited interpolation,
    which counts behind a reconstruction filter. Where the amplitude limit asks for more than the samples asked for,
    `amplitude_limit_binds` is set, `needed_samples` says how many there must be, and the signal is the one that needs
    them: the same energy in a longer record.
    """

    signal: FloatArray
    periods: int
    sample_time: float
    method: str
    crest_factor: float
    crest_factor_between_samples: float
    requested_energies: FloatArray
    achieved_energies: FloatArray
    amplitude_limit: float | None
    amplitude_limit_binds: bool
    needed_samples: int | None

    @property
    def period(self) -> int:
        """Samples of one period."""
        return len(self.signal)

    @property
    def samples(self) -> int:
        """Samples of the whole record."""
        return self.period * self.periods

    @property
    def duration(self) -> float:
        """Length of the whole record in seconds."""
        return self.samples * self.sample_time

    @property
    def energy(self) -> float:
        """Σ_t u(t)² of the whole record."""
        return float(self.periods * np.sum(self.signal**2))

    @property
    def peak(self) -> float:
        """max |u(t)|."""
        return float(np.abs(self.signal).max())

    def record(self) -> FloatArray:
        """The whole record (samples,): all periods one after another."""
        return np.tile(self.signal, self.periods)
