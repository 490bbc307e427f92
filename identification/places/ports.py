"""Which inputs and outputs of a plant with several an effect acts on."""

from dataclasses import dataclass

import numpy as np

from identification.arrays import BoolArray, IntArray


@dataclass(frozen=True)
class Port:
    """One output, one input, the path from one input to one output, or, where None, all of them; counted from 0."""

    output: int | None = None
    input: int | None = None

    def acts(self, channels: IntArray | None, rows: int) -> BoolArray:
        """On which rows (M,) of measurements of the channels (M, 2), output and input, None: one of each."""
        if channels is None:
            return np.ones(rows, dtype=np.bool_)
        acts: BoolArray = np.ones(rows, dtype=np.bool_)
        for stated, own in zip((self.output, self.input), channels.T, strict=True):
            if stated is not None:
                acts &= own == stated
        return acts

    def __str__(self) -> str:
        if self.output is None:
            return "" if self.input is None else f"at input {self.input + 1}"
        if self.input is None:
            return f"at output {self.output + 1}"
        return f"from input {self.input + 1} to output {self.output + 1}"


EVERYWHERE = Port()


def ports(outputs: int, inputs: int) -> tuple[Port, ...]:
    """All places of a plant with so many outputs and inputs: everywhere first, then outputs, inputs and paths."""
    found = [EVERYWHERE]
    if outputs > 1:
        found += [Port(i, None) for i in range(outputs)]
    if inputs > 1:
        found += [Port(None, k) for k in range(inputs)]
    if outputs > 1 and inputs > 1:
        found += [Port(i, k) for i in range(outputs) for k in range(inputs)]
    return tuple(found)
