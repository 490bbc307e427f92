"""The whole chain as one report."""

from app.report.chain.beginning import design_section, experiments_section, plant_section
from app.report.chain.documents import Chain
from app.report.chain.versions import comparison_section, diagnosis_section, model_section, side_by_side_plots
from app.report.document import Fact, Plot, Report, Section, Table
from app.report.figures.staircase import staircase
from app.report.numbers import percent, probability, significant


def chain_report(chain: Chain, title: str = "", introduction: str = "", first: tuple[Section, ...] = ()) -> Report:
    """All documents of a chain in the order in which they came about, after a summary; `first` goes before all."""
    return Report(
        title or f"{chain.plant.name}: {chain.version_name(chain.model)}",
        introduction
        or "All that led to this model: what was measured and designed, where each version of it failed,"
        " what was missing, and how the error fell.",
        tuple(_facts(chain)),
        (*first, *_sections(chain)),
    )


def _sections(chain: Chain) -> list[Section]:
    sections = _summary(chain)
    sections += [plant_section(chain)]
    sections += [design_section(chain, design) for design in chain.designs]
    sections += [experiments_section(chain)] if chain.experiments else []
    for number, model in enumerate(chain.versions):
        sections.append(model_section(chain, number))
        own = [one for one in chain.comparisons if one.document.model_id == model.id]
        sections += [comparison_section(chain, one, number) for one in own]
        found = [one for one in chain.diagnoses if one.model_id == model.id]
        sections += [diagnosis_section(chain, one, number) for one in found]
    return sections


def _summary(chain: Chain) -> list[Section]:
    blocks: list[Plot | Table] = []
    steps = chain.steps()
    if steps:
        blocks.append(staircase(steps))
    blocks += side_by_side_plots(chain)
    if not blocks:
        return []
    text = "Each version beside what was measured"
    if steps:
        text += ", and its error, before and after each effect was added"
    return [Section("How the error fell" if steps else "Model and measurement", (f"{text}.",), tuple(blocks))]


def _facts(chain: Chain) -> list[Fact]:
    facts, steps = [], chain.steps()
    if steps:
        first, last = steps[0], steps[-1]
        held_out = first.held_out is not None and last.held_out is not None
        before, after = (step.held_out if held_out else step.fitted for step in (first, last))
        what = "held-out error" if held_out else "error"
        facts.append(Fact(f"{percent(before or 0.0)} → {percent(after or 0.0)}", f"{what}, before and after"))
        names = ", ".join(one.title for one in chain.model.effects)
        facts.append(Fact(names, "found missing and added"))
        if last.p_value is not None:
            facts.append(Fact(probability(last.p_value), "p-value of the lack of fit that is left"))
    for design in chain.designs[:1]:
        if design.total_energy is not None and design.gap is not None:
            unit = chain.axes.energy_unit
            facts.append(Fact(f"{significant(design.total_energy, 4)} {unit}".strip(), "input energy of the design"))
            facts.append(Fact(significant(design.gap, 1), "certified gap to the least energy"))
            facts.append(Fact(str(len(design.experiments)), "operating points designed"))
    if chain.experiments:
        facts.append(Fact(str(len(chain.experiments)), "experiments"))
    return facts
