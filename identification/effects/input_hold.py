"""An input that is held between its samples, where the model takes it as band limited."""

from dataclasses import dataclass, replace
from typing import ClassVar, Self

import numpy as np

from identification.arrays import ComplexArray, FloatArray
from identification.errors import MisuseError
from identification.places.core import Plant, Reshaped
from identification.places.place import Flow, Setting
from identification.signals import HeldInput


@dataclass(frozen=True)
class InputHold(Reshaped):
    """Y = (G + e (H − G)) U, H the response as it is seen through a zero-order hold of `step` seconds; e = 1: held.

    At low frequencies it looks like a delay of half a sample. Only looked for where it was not said how the input runs
    between its samples, and in continuous time [AstromWittenmark1997, (2.4)].
    """

    kind: ClassVar[str] = "input_hold"
    title: ClassVar[str] = "input held between its samples"
    place: ClassVar[str] = "how the input is seen"
    unit: ClassVar[str] = "1"
    source: ClassVar[str] = "[AstromWittenmark1997, (2.4)]"
    sign: ClassVar[int] = 1
    largest: ClassVar[float | None] = 1.5
    on_entry: ClassVar[bool] = True
    unjudged: ClassVar[str] = "how the input runs between its samples is stated, or no matter to these data"

    step: float = 1.0

    def reshaped(
        self, e: FloatArray, plant: Plant, setting: Setting, omega: FloatArray, held: HeldInput | None
    ) -> ComplexArray:
        """G + e (H − G), (M, K) for e (M,)."""
        smooth = plant(setting.zeta, omega, held)
        seen = plant(setting.zeta, omega, HeldInput(self.step))
        return np.asarray(smooth + e[:, None] * (seen - smooth))

    def judgeable(self, flow: Flow) -> bool:
        """Only for samples of a model in continuous time whose hold is not stated."""
        structure = flow.setting.structure
        if flow.batch.sample_time is None or flow.batch.hold_stated or structure.is_discrete:
            return False
        try:
            structure.plant_response(flow.setting.zeta, flow.batch.omega[1:2], HeldInput(flow.batch.sample_time))
        except MisuseError:
            return False
        return True

    def variants(self, flow: Flow) -> list[Self]:
        """The sample time of the batch."""
        return [replace(self, step=float(flow.batch.sample_time or self.step))]
