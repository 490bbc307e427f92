"""What a design is expected to bring, beside what was asked for."""

from app.report.chain.documents import Chain
from app.report.document import Plot, Table
from app.report.figures.expected import expected_accuracy
from app.report.numbers import percent
from app.schemas.designs import Design
from oed.targets.parameter_deviation import ParameterDeviation


def expected_blocks(chain: Chain, design: Design) -> list[Plot | Table]:
    """Standard deviations of the parameters, and the power of decisions about effects."""
    blocks: list[Plot | Table] = []
    if design.expected_standard_deviations is not None:
        names = design.parameter_names
        asked, before = _asked(chain, design), _before(chain, design)
        in_order = [[values.get(name) for name in names] for values in (asked, before)]
        blocks.append(expected_accuracy(names, in_order[0], in_order[1], design.expected_standard_deviations))
    if design.decisions:
        blocks.append(_decisions(design))
    return blocks


def _before(chain: Chain, design: Design) -> dict[str, float]:
    """Those of the model that the design began with, by parameter, where it is in the chain and they are known."""
    began = [one for one in chain.versions if one.id == design.model_id]
    return {
        name: deviation
        for model in began
        for name, deviation in zip(model.parameter_names, model.standard_deviations or (), strict=False)
    }


def _asked(chain: Chain, design: Design) -> dict[str, float]:
    """The strictest standard deviation that any target asks for directly, of each parameter that has one."""
    found: dict[str, float] = {}
    for target in (one.build() for one in design.request.targets):
        if isinstance(target, ParameterDeviation):
            for name, value in zip(chain.plant.parameter_names, target.standard_deviations, strict=False):
                if value is not None:
                    found[name] = min(value, found.get(name, value))
    return found


def _decisions(design: Design) -> Table:
    rows = tuple(
        (
            f"see {one.effect}" if one.against is None else f"tell {one.effect} from {one.against}",
            percent(one.level),
            percent(one.asked_power),
            percent(one.expected_power),
        )
        for one in design.decisions
    )
    return Table(("decision", "level", "power asked for", "power expected"), rows)
