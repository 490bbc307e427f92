"""Where a model fails and what it lacks, with the library alone: compare, diagnose, add, and the figures as a report.

OPENBLAS_NUM_THREADS=1 python examples/missing_effect.py [REPORT.html]
"""

import sys
from pathlib import Path

import numpy as np

from app.report.axes import Axes
from app.report.document import Report
from app.report.findings import comparison_section, diagnosis_section, staircase_section
from app.report.page import write
from app.virtual_plant.campaign import first_campaign
from app.virtual_plant.hidden import EFFECTS
from app.virtual_plant.stage import Stage
from identification.bases.polynomial import Polynomial
from identification.comparison.compare import compare
from identification.comparison.gather import gather
from identification.diagnosis.staircase import conclusion, staircase
from identification.models.model import Model
from identification.models.rational import RationalStructure
from identification.scheduling import ParameterDependence, ProductBasis, SchedulingVariable

# The model: a stage whose stiffness a2 is affine in its position, x = jω/60.
position = SchedulingVariable("position", "m", 0.0, 0.6)
degrees = {"a1": 0, "a2": 1, "b0": 0}
dependence = ParameterDependence((position,), tuple(ProductBasis((Polynomial(n),)) for n in degrees.values()))
start = np.array([0.2, 1.7, -1.5, 0.19])
guess = Model(RationalStructure(2, 0, frequency_scale=60.0), dependence, start, np.zeros((4, 4)), 1.0)
axes = Axes((position,), "force", "N", "deflection", "mm")


def main(path: Path | None) -> None:
    # In place of a test bench: a simulated stage with dry friction, which the model does not know.
    campaign = first_campaign(Stage(EFFECTS["coulomb_friction"]), np.random.default_rng(1))
    fitted, held_out = gather(campaign.fitted), gather(campaign.held_out)

    steps = staircase(guess, fitted, held_out)
    for step in steps:
        names = [one.effect.title for one in step.model.effects] or ["no effects"]
        print(f"{', '.join(names)}: error {step.error:.4f}, held out {step.held_out_error:.4f}")
    print(conclusion(steps))

    if path is not None:
        first, last = steps[0], steps[-1]
        sections = [
            staircase_section("How the error fell", steps),
            comparison_section("At first", compare(first.model, fitted), fitted, campaign.fitted, axes),
            diagnosis_section("What is missing", first.diagnosis, campaign.fitted, axes),
            comparison_section("In the end", compare(last.model, fitted), fitted, campaign.fitted, axes),
        ]
        print(f"report in {write(Report('A stage with friction', '', sections=tuple(sections)), path)}")


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else None)
