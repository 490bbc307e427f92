"""A version of a model: its parameters, where it fails, what it lacks."""

import numpy as np

from app.report.chain.blocks import RESIDUALS, comparison_blocks, diagnosis_blocks, diagnosis_text
from app.report.chain.documents import Chain, Compared
from app.report.document import Plot, Section, Table
from app.report.effect_text import amplitude
from app.report.figures.bode import bode
from app.report.figures.poles import poles
from app.report.figures.versions import side_by_side
from app.report.numbers import estimate, significant
from app.schemas.diagnoses import Diagnosis
from app.schemas.models import Model as ModelDocument
from identification.arrays import FloatArray
from identification.comparison.gather import gather
from identification.errors import MisuseError
from identification.models.model import Model
from identification.signals import OperatingPoint

FINE = 81
FREQUENCIES = 201
MOST_PARAMETERS = 200


def model_section(chain: Chain, number: int) -> Section:
    """The parameters of a version with their accuracy, its effects and its poles."""
    model = chain.versions[number]
    text = {
        "stated": "Its parameters were stated.",
        "identified": f"Identified from {len(model.experiment_ids)} experiments.",
        "extended": f"All its parameters fitted together to {len(model.experiment_ids)} experiments.",
    }
    blocks: list[Plot | Table] = [_parameters(model)]
    if model.effects:
        rows = tuple((one.title, one.place, amplitude(one)) for one in model.effects)
        blocks.append(Table(("effect", "acts", "amplitude ± σ"), rows, text_columns=3))
    blocks += _curves(chain, model)
    title = f"Version {number + 1}: {chain.version_name(model)}"
    return Section(title, (text.get(model.origin, ""),), tuple(blocks))


def _parameters(model: ModelDocument) -> Table:
    deviations = model.standard_deviations or [float("nan")] * len(model.theta)
    shown = list(zip(model.parameter_names, model.theta, deviations, strict=False))[:MOST_PARAMETERS]
    rows = tuple((name, estimate(value, sigma)) for name, value, sigma in shown)
    return Table(("parameter", "estimate ± σ"), rows)


def _curves(chain: Chain, model: ModelDocument) -> list[Plot]:
    """Bode plot and poles over one scheduling variable, where there are no effects and the accuracy is known."""
    known = chain.rational(model)
    if known is None or known.effects or model.covariance is None or len(chain.axes.variables) != 1:
        return []
    variable = chain.axes.variables[0]
    along = np.linspace(variable.minimum, variable.maximum, FINE)[:, None]
    some: list[OperatingPoint] = [(float(p),) for p in along[[0, FINE // 2, -1], 0]]
    plots = [bode(known, some, _frequencies(chain, known), chain.axes)]
    return [*plots, poles(known, along, chain.axes)] if known.structure.order else plots


def _frequencies(chain: Chain, model: Model) -> FloatArray:
    """Those that were excited; without experiments two decades up to the Nyquist frequency or around the scale."""
    known = [one.understood for one in chain.experiments]
    low = [one.minimum_frequency_rad_per_second for one in known if one.minimum_frequency_rad_per_second]
    high = [one.maximum_frequency_rad_per_second for one in known if one.maximum_frequency_rad_per_second]
    if low and high and min(low) < max(high):
        return np.geomspace(min(low), max(high), FREQUENCIES)
    step = model.structure.sample_time
    top = 10 * model.structure.frequency_scale if step is None else np.pi / step
    return np.geomspace(top / 100, top, FREQUENCIES)


def comparison_section(chain: Chain, compared: Compared, number: int) -> Section:
    """Where a version fails."""
    rows, parts = chain.map_rows(compared), compared.document.parts
    blocks = comparison_blocks(rows, parts, chain.axes)
    return Section(f"Version {number + 1} against measurements", (RESIDUALS,), (*blocks, _fit_table(chain, compared)))


def _fit_table(chain: Chain, compared: Compared) -> Table:
    rows = tuple(
        (
            chain.labels.get(one.experiment_id, one.experiment_id),
            "held out" if one.data == "heldOut" else "fitted",
            _percent(one.fit_percent),
            _percent(one.refit_percent),
        )
        for one in compared.document.experiments
    )
    heads = ("experiment", "data", "fit 100 (1 − ‖y − ŷ‖/‖y‖)", "after a refit it would be")
    return Table(heads, rows, text_columns=2)


def _percent(value: float | None) -> str:
    return "–" if value is None else f"{significant(value, 4)} %"


def diagnosis_section(chain: Chain, diagnosis: Diagnosis, number: int) -> Section:
    """What a version lacks."""
    blocks = diagnosis_blocks(diagnosis, chain.labels, chain.axes)
    return Section(f"What version {number + 1} lacks", (diagnosis_text(diagnosis),), tuple(blocks))


def side_by_side_plots(chain: Chain) -> list[Plot]:
    """The last version without effects and the latest one in up to three experiments, held-out ones before others."""
    plain = [model for model in chain.versions if not model.effects] or [chain.versions[0]]
    ends = [plain[-1]] if chain.model is plain[-1] else [plain[-1], chain.model]
    known = [(chain.version_name(model), chain.rational(model)) for model in ends]
    versions = [(name, model) for name, model in known if model is not None]
    fitted = {name for model in chain.versions for name in model.experiment_ids}
    chosen = sorted(chain.experiments, key=lambda one: one.id in fitted)
    plots: list[Plot] = []
    for one in chosen:
        if chain.measurement is None or not versions or len(plots) == 3:
            break
        if one.kind not in ("timeRecord", "frequencyResponse"):
            continue
        try:
            batch = gather([chain.measurement(one)])[0]
            plots.append(side_by_side(versions, batch, chain.labels[one.id], chain.axes))
        except MisuseError:
            continue
    return plots
