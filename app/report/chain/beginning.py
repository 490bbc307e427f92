"""What was known, what was measured, what was designed."""

from app.conversion.designs import candidate_points
from app.conversion.plants import plant_dependence
from app.conversion.spectra import spectrum_object
from app.report.axes import labelled
from app.report.chain.documents import Chain
from app.report.chain.expected import expected_blocks
from app.report.document import Plot, Section, Table
from app.report.figures.energies import energy_per_point
from app.report.figures.signals import signal_table, signals
from app.report.figures.spectra import spectra
from app.report.numbers import percent, significant
from app.schemas.designs import Design
from oed.design import DesignedExperiment


def plant_section(chain: Chain) -> Section:
    """The plant as it was described."""
    plant = chain.plant
    rows = [("scheduling variable", f"{v.name}, {v.minimum:g} to {v.maximum:g} {v.unit}") for v in chain.axes.variables]
    rows += [("input", chain.axes.input), ("output", labelled(chain.axes.output_name, chain.axes.output_unit))]
    rows.append(("structure", plant.structure.words))
    rows.append(("parameters", ", ".join(plant.parameter_names)))
    paragraphs = (plant.description,) if plant.description else ()
    return Section(f"The plant: {plant.name}", paragraphs, (Table(("what", "value"), tuple(rows), text_columns=2),))


def experiments_section(chain: Chain) -> Section:
    """What was measured, and what of it the model has seen."""
    fitted = {name for model in chain.versions for name in model.experiment_ids}
    rows = []
    for one in sorted(chain.experiments, key=lambda one: one.operating_point or []):
        known = one.understood
        rows.append(
            (
                chain.labels[one.id],
                chain.place(one),
                "fitted" if one.id in fitted else "held out",
                {"timeRecord": "record", "frequencyResponse": "frequency response"}.get(one.kind, "other"),
                "–" if known.samples is None else str(known.samples),
                str(known.frequency_count),
                "–" if known.noise_level is None else significant(known.noise_level, 2),
            )
        )
    noise = labelled("noise σ", chain.axes.output_unit)
    heads = ("experiment", "operating point", "data", "kind", "samples", "lines", noise)
    return Section("The experiments", (), (Table(heads, tuple(rows), text_columns=4),))


def design_section(chain: Chain, design: Design) -> Section:
    """The design with its certificate."""
    blocks: list[Plot | Table] = [_certificate(chain, design)]
    if design.experiments:
        made = [
            DesignedExperiment(
                tuple(one.operating_point), one.energy, spectrum_object(one.spectrum, design.sample_time_seconds)
            )
            for one in design.experiments
        ]
        offered = candidate_points(design.request, plant_dependence(chain.plant))
        blocks.append(energy_per_point(made, offered, chain.axes))
        blocks.append(spectra(made, design.samples, design.sample_time_seconds, chain.axes))
        blocks += expected_blocks(chain, design)
    for played in chain.signals:
        if played.document.design_id == design.id:
            points = [tuple(one.operating_point) for one in played.document.signals]
            blocks += [
                signal_table(points, played.realised(), chain.axes),
                signals(points, played.realised(), chain.axes),
            ]
    text = (
        "The operating points and input spectra of least energy that give the accuracy asked for, and a bound below"
        " which no design of this kind can fall.",
        *([design.outcome.advice] if design.outcome.advice else []),
    )
    return Section("The designed experiments", text, tuple(blocks))


def _certificate(chain: Chain, design: Design) -> Table:
    unit = chain.axes.energy_unit
    numbers: list[tuple[str, float | None, int]] = [
        (labelled("energy of the design (primal value)", unit), design.total_energy, 6),
        (labelled("no design can need less than (dual value)", unit), design.lower_bound, 6),
        ("relative gap", design.gap, 2),
    ]
    rows = [(name, "–" if value is None else significant(value, digits)) for name, value, digits in numbers]
    rows.append(("samples of each experiment", str(design.samples)))
    targets = [binding for binding in design.binding if binding.what == "target" and binding.multiplier is not None]
    for binding in targets if len(targets) > 1 else ():
        target = f"target {1 + (binding.target_index or 0)}"
        rows.append((f"share of the energy due to {target}", percent(binding.multiplier or 0.0)))
    return Table(("certificate", "value"), tuple(rows))
