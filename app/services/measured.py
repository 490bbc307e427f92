"""Which experiments a model is held against, and whether they fit it."""

from collections.abc import Sequence
from typing import Any

from app.conversion.channels import channels_of, foreign_effect
from app.conversion.effects import effect_of
from app.conversion.experiments import logged_values
from app.conversion.plants import is_state_space
from app.errors import UnprocessableError
from app.schemas.experiments import Experiment
from app.schemas.models import Model
from app.schemas.plants import DiscreteStateSpaceStructure, DiscreteTimeStructure, Plant
from app.services.documents import named_of_plant
from app.services.experiments import KIND, experiment_of, local_experiments
from app.services.fitting import SAMPLE_TIME_TOLERANCE
from app.services.models import model_of
from app.store.resources import ResourceRepository

Measured = tuple[Experiment, str]
LEAST_PERIODS = 2


def measured_of_plant(
    resources: ResourceRepository, identifiers: Sequence[str], plant_id: str, pointer: str, along: bool = False
) -> list[Measured]:
    """The experiments that a list in the body names, with the hashes of their arrays.

    With `along` also records in which the scheduling varied, which are refused otherwise.
    """
    found = named_of_plant(resources, KIND, identifiers, plant_id, pointer) if along else None
    rows = local_experiments(resources, identifiers, plant_id, pointer) if found is None else found
    return [(experiment_of(row), row.arrays or "") for row in rows]


def payload_of(experiments: Sequence[Measured]) -> list[dict[str, Any]]:
    """The experiments as a task gets them."""
    return [{"document": experiment.as_json(), "arrays": arrays} for experiment, arrays in experiments]


def fitted_experiments(resources: ResourceRepository, model: Model) -> set[str]:
    """The experiments that a model or a version before it was fitted to."""
    fitted, seen = set(model.experiment_ids), {model.id}
    while model.parent_id is not None and model.parent_id not in seen:
        row = resources.find("models", model.parent_id)
        if row is None:
            break
        model = model_of(row)
        seen.add(model.id)
        fitted |= set(model.experiment_ids)
    return fitted


def check_time_domain(model: Model, experiments: Sequence[Measured], pointer: str) -> None:
    """Raises UnprocessableError at the experiment whose sampling is not that of a model in discrete time.

    Also for a state-space model, which is not held against measurements here unless its dependence is affine and it
    comes from varying scheduling; then at experiments at operating points when it has several inputs or outputs.
    """
    if model.varying is not None:
        _check_channels(model, experiments, pointer)
    elif is_state_space(model.structure):
        raise UnprocessableError.at(
            "/modelId",
            "this is a state-space model, whose errors its own document states; only rational models are compared and"
            " diagnosed",
        )
    if not isinstance(model.structure, DiscreteTimeStructure | DiscreteStateSpaceStructure):
        return
    own = model.structure.sample_time_seconds
    for i, (experiment, _) in enumerate(experiments):
        given = experiment.sample_time_seconds
        if given is None or abs(given / own - 1) > SAMPLE_TIME_TOLERANCE:
            what = "in continuous time" if given is None else f"sampled every {given:g} s"
            raise UnprocessableError.at(
                f"{pointer}/{i}", f"the experiment is {what}, the model every {own:g} s; compare data of one sampling"
            )


def _check_channels(model: Model, experiments: Sequence[Measured], pointer: str) -> None:
    assert model.state_space is not None, "models from varying scheduling are in state space"
    one = model.state_space.input_count == model.state_space.output_count == 1
    for i, (experiment, _) in enumerate(experiments):
        if experiment.operating_point is None and model.effects:
            raise UnprocessableError.at(
                f"{pointer}/{i}",
                "the model carries effects, whose response is known at operating points that are held still, not along"
                " p(t); give experiments at such points, or compare its parent",
            )
        if experiment.operating_point is not None and not one:
            raise UnprocessableError.at(
                f"{pointer}/{i}",
                "the operating point was held still in this experiment; a model from varying scheduling is held against"
                " such experiments only when it has one input and one output; give records along varying scheduling",
            )


def periodic(experiment: Experiment) -> bool:
    """Whether an experiment is a record of at least two periods, so that its unexcited lines say something."""
    periods = experiment.understood.periods
    return experiment.kind == "timeRecord" and periods is not None and periods >= LEAST_PERIODS


def check_effect(kind: str, plant: Plant, experiments: Sequence[Measured], pointer: str) -> None:
    """Raises UnprocessableError for an effect that is not in the library or that plant or experiments cannot show."""
    effect = effect_of(kind)
    if effect is None:
        raise UnprocessableError.at(pointer, f"there is no effect {kind}; /v1/catalogue names those that there are")
    why = foreign_effect(effect, channels_of(plant))
    if why:
        raise UnprocessableError.at(pointer, why)
    if kind == "second_variable" and not common_quantities(experiments):
        raise UnprocessableError.at(
            pointer,
            f"{effect.title}: there is no quantity that was logged in all of these experiments in one unit; state it"
            " among their loggedQuantities",
        )
    if effect.needs_records and not all(experiment.kind == "timeRecord" for experiment, _ in experiments):
        raise UnprocessableError.at(
            pointer,
            f"{effect.title} shows only in time records, and some of the experiments are frequency responses; bring in"
            " the records, or ask for effects that act linearly",
        )


def common_quantities(experiments: Sequence[Measured]) -> list[str]:
    """The logged quantities, with their units, that all experiments state."""
    return sorted(set.intersection(*(set(logged_values(experiment)) for experiment, _ in experiments)))


def chosen_quantity(kind: str, asked: str | None, experiments: Sequence[Measured]) -> str | None:
    """The logged quantity that a second variable is; raises UnprocessableError when it is not clear which."""
    if kind != "second_variable":
        if asked is not None:
            raise UnprocessableError.at("/quantity", f"{kind} depends on no logged quantity; leave it out")
        return None
    known = common_quantities(experiments)
    fitting = known if asked is None else [one for one in known if asked in (one, one.rpartition(" [")[0])]
    if len(fitting) != 1:
        raise UnprocessableError.at("/quantity", f"name one of the logged quantities: {', '.join(known)}")
    return fitting[0]


def check_logged(model: Model, experiments: Sequence[Measured], pointer: str) -> None:
    """Raises UnprocessableError at the experiment that does not state a quantity on which the model depends."""
    needed = {one.quantity for one in model.effects if one.quantity is not None}
    for i, (experiment, _) in enumerate(experiments):
        missing = sorted(needed - set(logged_values(experiment)))
        if missing:
            raise UnprocessableError.at(
                f"{pointer}/{i}",
                f"the model depends on {', '.join(missing)}, which the experiment does not state in this unit; bring it"
                " in with loggedQuantities",
            )
