"""Under which conditions a time record was made: what a signal means beside its samples."""

from typing import Literal

from pydantic import Field

from app.schemas.common import CamelModel, Double

InputHold = Literal["zeroOrder", "firstOrder", "bandLimited"]


class RecordConditions(CamelModel):
    """What is stated of a time record at an operating point that was held still."""

    input_level: Double | None = Field(
        default=None,
        description="value of the input that belongs to the operating point, about which it moves; not stated: its"
        " mean, which then says nothing about the gain at zero frequency",
    )
    output_level: Double | None = Field(
        default=None, description="value of the output when the input stands at `inputLevel`; not stated: its mean"
    )
    input_hold: InputHold | None = Field(
        default=None, description="how the input runs between its samples; not stated: not known"
    )
    feedback: bool = Field(default=False, description="whether a controller acted on the output while recording")

    @property
    def stated(self) -> bool:
        """Whether anything was said."""
        return self.feedback or (self.input_level, self.output_level, self.input_hold) != (None, None, None)
