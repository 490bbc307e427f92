"""The loop walked on a simulated stage: design, measure, fit, see the failure, find what is missing, add it."""

from dataclasses import dataclass, replace

import numpy as np

from app.conversion.models import kept_model
from app.demo import task
from app.demo.laboratory import Laboratory
from app.jobs.tasks.design import stated_problem
from app.offline.loop import Loop
from app.offline.workplace import DESIGN_ID, PLANT_ID, Workplace, stored
from app.report.chain.documents import Chain, Compared, Played
from app.report.figures.accuracy import Accuracy
from app.schemas.designs import Design, DesignRequest
from app.schemas.diagnoses import Diagnosis
from app.schemas.models import Model as ModelDocument
from app.schemas.models import ModelRequest
from app.schemas.outcomes import OutcomeDocument
from app.schemas.plants import Plant
from app.schemas.signals import Signals, SignalsRequest
from app.services import designs, models, signals
from app.services.measured import Measured
from app.virtual_plant.campaign import SAMPLE_TIME
from identification.errors import MisuseError
from identification.models.model import Model
from oed.design import design
from oed.spectra.fir import FirSpectra

IDENTIFICATION = {
    "localEstimator": {"kind": "rational_fit"},
    "lpvEstimator": {"kind": "joint_likelihood"},
    "spectralEstimator": {"kind": "periodic_average"},
}


@dataclass(frozen=True, eq=False)
class Designed:
    """The design of the second experiment, its signals, and the energy that other ways would need."""

    design: Design
    played: Played
    alternatives: tuple[tuple[str, float], ...]


@dataclass(frozen=True, eq=False)
class Story:
    """All that happened: `versions` from the first model to the last, `compared` and `diagnosed` from the second on."""

    seed: int
    hidden: str
    designed: Designed
    loop: Loop
    versions: tuple[ModelDocument, ...]
    compared: tuple[Compared, ...]
    diagnosed: tuple[Diagnosis, ...]

    @property
    def chain(self) -> Chain:
        """For the report."""
        return self.loop.chain(
            list(self.versions),
            list(self.compared),
            list(self.diagnosed),
            (self.designed.design,),
            (self.designed.played,),
        )

    @property
    def found(self) -> list[str]:
        """Kinds of effects that were added."""
        return [one.kind for one in self.versions[-1].effects]

    def plain(self, model: ModelDocument) -> Model:
        """A model without its effects."""
        return kept_model(model, self.loop.plant)

    def accuracy(self, model: ModelDocument) -> Accuracy:
        """Standard deviations of θ, asked, expected and reached, and the errors that were made."""
        expected = np.array(self.designed.design.expected_standard_deviations, dtype=np.float64)
        error = np.array(model.theta) - task.true_parameters()
        return Accuracy(task.PARAMETERS, task.ASKED, expected, np.array(model.standard_deviations), error)


def identified(place: Workplace, plant: Plant, experiments: list[Measured], name: str) -> ModelDocument:
    """A model from experiments."""
    names = [one.id for one, _ in experiments]
    request = ModelRequest.model_validate({"plantId": plant.id, "name": name, "experimentIds": names, **IDENTIFICATION})
    found = place.run("identification", models.payload(plant, request, experiments))
    model = ModelDocument.model_validate(stored(found.document, name, plantId=PLANT_ID, jobId=None))
    _require(model.outcome)
    return model


def designed_second(place: Workplace, plant: Plant, first: ModelDocument, energy: float, seed: int) -> Designed:
    """The least energy that adds what the first experiment has not told, as signals to play [Ghosh2018, Section 4]."""
    request = design_request(first)
    found = place.run("design", designs.payload(plant, first, request))
    made = Design.model_validate(stored(found.document, DESIGN_ID, plantId=PLANT_ID, jobId=None))
    _require(made.outcome)
    if not made.experiments:
        raise MisuseError("the first experiment happens to be accurate enough already; try another seed", "seed")
    asked = SignalsRequest(samples=task.PERIOD, periods=task.PERIODS, seed=seed)
    played = place.run("signals", signals.payload(made, asked))
    document = Signals.model_validate(stored(played.document, "signals", plantId=PLANT_ID, jobId=None))
    own = Played(document, place.arrays.get(played.arrays or ""))
    return Designed(made, own, _alternatives(plant, first, request, made, energy))


def design_request(first: ModelDocument) -> DesignRequest:
    """Standard deviations of the four parameters, with what the first experiment has told as prior information."""
    wanted = [float(sigma) for sigma in (1 - task.MARGIN) * task.ASKED]
    axis = {"minimum": task.POSITION.minimum, "maximum": task.POSITION.maximum, "count": task.GRID}
    return DesignRequest.model_validate(
        {
            "plantId": PLANT_ID,
            "modelId": first.id,
            "operatingPoints": {"kind": "gridAxes", "axes": [axis]},
            "targets": [{"kind": "parameter_deviation", "standardDeviations": wanted}],
            "spectrumFamily": {"kind": "lines", "samples": task.PERIOD},
            "samples": task.PERIOD * task.PERIODS,
            "sampleTimeSeconds": SAMPLE_TIME,
            "band": {"minimumRadPerSecond": task.BAND[0], "maximumRadPerSecond": task.BAND[1]},
            "usePriorInformation": True,
            "tolerance": task.TOLERANCE,
        }
    )


def _alternatives(
    plant: Plant, first: ModelDocument, request: DesignRequest, made: Design, energy: float
) -> tuple[tuple[str, float], ...]:
    """Energies: as designed; white noise at the best positions; repeating the first experiment.

    s times the first experiment give s P_θ₁⁻¹ ⪰ R, so s is the largest eigenvalue of R P_θ₁.
    """
    known = kept_model(first, plant)
    problem = replace(stated_problem(request, known, True), family=FirSpectra(0), band=None)
    sigma = (1 - task.MARGIN) * task.ASKED
    times = float(np.linalg.eigvalsh(known.theta_covariance / np.outer(sigma, sigma))[-1])
    return (
        ("designed", made.total_energy or 0.0),
        ("white noise at the best positions", design(problem).total_energy),
        ("more of the first experiment", max(times - 1, 0.0) * energy),
    )


def energy_of(lab: Laboratory, experiments: list[Measured]) -> float:
    """Σ u² over all samples of all experiments."""
    return float(sum(np.sum(lab.place.arrays.get(arrays)["input"] ** 2) for _, arrays in experiments))


def _require(outcome: OutcomeDocument) -> None:
    if outcome.status != "converged":
        raise MisuseError(f"the demonstration cannot go on: {outcome.advice}; try another seed", "seed")
