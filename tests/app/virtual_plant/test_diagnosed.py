"""What the diagnosis says of the simulated plant."""

import numpy as np

from app.virtual_plant.campaign import FREQUENCY_SCALE, first_campaign
from app.virtual_plant.hidden import EFFECTS
from app.virtual_plant.stage import LENGTH, Stage
from identification.bases.polynomial import Polynomial
from identification.comparison.gather import gather
from identification.diagnosis.diagnose import diagnose
from identification.effects.library import library
from identification.models.model import Model
from identification.models.rational import RationalStructure
from identification.scheduling import ParameterDependence, ProductBasis, SchedulingVariable

POSITION = SchedulingVariable("position", "m", 0.0, LENGTH)
DEPENDENCE = ParameterDependence((POSITION,), tuple(ProductBasis((Polynomial(n),)) for n in (0, 1, 0)))
KINDS = ("cubic_stiffness", "gravity")
STRUCTURE = RationalStructure(2, 0, frequency_scale=FREQUENCY_SCALE)


def test_a_start_that_makes_things_worse_is_not_the_last_word_on_an_effect():
    """Here the amplitude that the score of the sinusoidal force points to is far too large for a refit to begin at."""
    model = Model(STRUCTURE, DEPENDENCE, np.array([0.22, 1.66, -1.48, 0.185]), np.eye(4), 1.0)
    campaign = first_campaign(Stage(EFFECTS["cubic_stiffness"]), np.random.default_rng(2))
    found = diagnose(model, gather(campaign.fitted), [one for one in library() if one.kind in KINDS])
    assert min(one.explained for one in found.evidence) > 0
    assert found.best is not None
    assert found.best.score.candidate.effect.kind == "cubic_stiffness"
