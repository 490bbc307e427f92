"""The few named errors of misuse. A solve that does not succeed is no error: see `identification.outcome`."""


class MisuseError(ValueError):
    """The request cannot be answered as it stands; the message says what to change.

    `field` names the offending argument, where there is one.
    """

    def __init__(self, message: str, field: str | None = None) -> None:
        super().__init__(message)
        self.field = field


class ShapeError(MisuseError):
    """Arrays whose sizes do not fit each other."""


class RangeError(MisuseError):
    """A value outside the range in which it has a meaning."""


class NotIdentifiableError(MisuseError):
    """The data cannot determine the parameters asked for, whatever the estimator."""


class TooFewOperatingPointsError(NotIdentifiableError):
    """Fewer distinct operating points than the dependence on the scheduling variables needs [Ghosh2018, Theorem 1]."""

    def __init__(self, needed: int, given: int, detail: str = "") -> None:
        super().__init__(
            f"{given} distinct operating points were given, at least {needed} are needed for these basis functions"
            f"{detail}; measure at more operating points or choose basis functions of lower order",
            "operating_points",
        )
        self.needed = needed
        self.given = given
