"""The report of the demonstration."""

import numpy as np

from app.demo import task
from app.demo.story import Story
from app.demo.tables import asked_table, estimate_table
from app.report.document import Fact, Report, Section
from app.report.figures.accuracy import accuracy
from app.report.figures.bode import bode, gain_accuracy
from app.report.figures.convergence import certificate_table, convergence
from app.report.figures.energies import energy_comparison, energy_per_point
from app.report.figures.poles import pole_accuracy, poles
from app.report.figures.residuals import residual_correlation, test_table
from app.report.figures.signals import signal_table, signals
from app.report.figures.spectra import spectra
from app.report.numbers import percent, significant

OMEGA = np.geomspace(0.01, np.pi / task.SAMPLE_TIME, 121)
FINE = np.linspace(task.VELOCITY.minimum, task.VELOCITY.maximum, 81)[:, None]


def demo_report(story: Story) -> Report:
    """All that was designed, measured and found."""
    return Report(
        "A heater in a duct: designed, measured, identified",
        "A simulated plant whose dynamics change with the air velocity, walked once round the loop of lpv-oed: a first"
        " experiment, a designed second one with a certificate, and a model with the accuracy that was asked for.",
        _facts(story),
        (
            _plant(),
            _first(story),
            _design(story),
            _certificate(story),
            _signals(story),
            _model(story),
            _reached(story),
            _residuals(story),
        ),
    )


def _facts(story: Story) -> tuple[Fact, ...]:
    unit, designed = task.AXES.energy_unit, story.designed.design
    points = ", ".join(f"{experiment.operating_point[0]:g}" for experiment in designed.experiments)
    more = story.designed.alternatives[-1][1]
    return (
        Fact(f"{significant(designed.total_energy, 4)} {unit}", "input energy of the designed experiment"),
        Fact(f"{significant(more, 4)} {unit}", "input energy without a design, for the same accuracy"),
        Fact(f"{points} {task.VELOCITY.unit}", "operating points chosen"),
        Fact(significant(designed.gap, 1), "certified gap to the least energy"),
        Fact(percent(story.worst_share), "of the σ asked for, in the worst direction"),
    )


def _plant() -> Section:
    text = (
        "The heater warms the air that flows through a duct. In still air it acts slowly and strongly, in a gale fast"
        " and weakly. Input: heater power in kW; output: outlet temperature in K; both as deviations from the working"
        " point, once a second. The scheduling variable is the air velocity v, between 0 and 8 m/s.",
        "Model: y = B/A u + 1/D e with A = 1 + a1 q⁻¹, B = b0 q⁻¹, D = 1 + d1 q⁻¹, every coefficient affine in v:"
        " a1(v) = a1[0] + a1[1] v, and so on. These six numbers are to be known with the standard deviations σ below,"
        " all directions of the parameter space included. The design aims"
        f" {percent(task.MARGIN, 1)} better, for it rests on an estimate.",
    )
    return Section("What is asked", text, (asked_table(),))


def _first(story: Story) -> Section:
    velocities = ", ".join(f"{v:g}" for v in task.FIRST_POINTS)
    text = (
        f"A random binary signal of ±{significant(task.FIRST_POWER)} kW, {task.SAMPLES} samples at each of {velocities}"
        f" m/s: {significant(story.first.energy, 4)} {task.AXES.energy_unit} of input energy in all. A local model is"
        " identified at each velocity, and generalised least squares joins them.",
    )
    return Section("A first experiment", text, (estimate_table(story.initial),))


def _design(story: Story) -> Section:
    designed = story.designed
    text = (
        "The second experiment is the one of least input energy that, together with the first, gives the accuracy"
        f" asked for. It may use any of {len(task.GRID)} velocities, with any spectrum of degree {task.FIR_DEGREE}.",
    )
    experiments = designed.design.experiments
    blocks = (
        energy_per_point(experiments, task.GRID, task.AXES),
        spectra(experiments, task.SAMPLES, task.SAMPLE_TIME, task.AXES),
        energy_comparison(designed.alternatives, task.AXES),
    )
    return Section("The designed experiment", text, blocks)


def _certificate(story: Story) -> Section:
    designed = story.designed
    text = (
        "The solver gives two numbers: the energy of the design (primal value), and one below which no design with"
        " these velocities and spectra can fall (dual value). It stops when they are close enough.",
    )
    table = certificate_table(designed.design, task.AXES, ("standard deviations",))
    return Section("The certificate", text, (table, convergence(designed.history, task.TOLERANCE)))


def _signals(story: Story) -> Section:
    text = (
        "Each spectrum is played as a multisine: its lines have exactly the designed energies, and its phases are"
        " optimised for a low crest factor (peak over root mean square). Where the amplitude limit asks for it, the"
        " same energy is spread over more periods.",
    )
    blocks = (
        signal_table(story.second.points, story.signals, task.AXES),
        signals(story.second.points, story.signals, task.AXES),
    )
    return Section("The signals", text, blocks)


def _model(story: Story) -> Section:
    text = (
        "All records of both experiments together give the final model (joint maximum likelihood). Because the plant"
        " is simulated, the truth is known and can be laid over it.",
    )
    model, truth, points = story.final.model, task.true_model(), story.second.points
    models = (("after the first experiment", story.initial.model), ("after both", model))
    local = (*story.first.local, *story.second.local)
    blocks = (
        bode(model, points, OMEGA, task.AXES, story.responses, truth),
        gain_accuracy(models, points, OMEGA, task.AXES, truth),
        poles(model, FINE, task.AXES, local, truth),
        pole_accuracy(models, FINE, task.AXES, truth),
    )
    return Section("The model", text, blocks)


def _reached(story: Story) -> Section:
    text = (
        f"In the worst direction of the parameter space σ is {percent(story.worst_share)} of what was asked."
        " The σ reached are estimated from the data, so they scatter a little around those that the design expected;"
        " the actual error is one draw and should stay within 2 σ in nineteen cases of twenty.",
    )
    return Section("Asked and reached", text, (estimate_table(story.final), accuracy(story.accuracy)))


def _residuals(story: Story) -> Section:
    text = (
        "If the model is right, what it cannot predict is white noise, independent of the past input, and one"
        " dependence on the velocity fits all experiments.",
    )
    tests = test_table(story.final.tests)
    plot = residual_correlation(story.second.points, story.prediction_errors, task.AXES)
    return Section("What is left over", text, (plot, tests))
