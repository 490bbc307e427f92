"""The report of the demonstration: the whole chain, and what was asked, expected and reached."""

from dataclasses import replace

import numpy as np

from app.demo import task
from app.demo.story import Story
from app.demo.tables import asked_table, estimate_table
from app.report.chain.build import chain_report
from app.report.document import Plot, Report, Section, Table
from app.report.figures.accuracy import accuracy
from app.report.figures.bode import gain_accuracy
from app.report.figures.energies import energy_comparison
from app.report.numbers import percent

OMEGA = np.geomspace(*task.BAND, 121)


def demo_report(story: Story) -> Report:
    """All that was designed, measured and found."""
    return chain_report(
        story.chain,
        "A positioning stage: designed, measured, found wanting, mended",
        "A simulated stage that does something its model does not know, walked round the loop of lpv-oed: a first"
        " experiment, a designed second one with a certificate, a model whose stated accuracy speaks of noise alone,"
        " the effect that it lacks, and what is left when that is added.",
        (_asked(), _energy(story), _reached(story)),
    )


def _asked() -> Section:
    text = (
        "The stage is pushed by a force and gives way; the farther out it stands, the softer it is. Its model has four"
        " parameters, which are to be known with the standard deviations σ below. The design aims"
        f" {percent(task.MARGIN, 1)} better, for it rests on an estimate.",
    )
    return Section("What is asked", text, (asked_table(),))


def _energy(story: Story) -> Section:
    text = ("What the designed second experiment costs, and what other ways would cost for the same accuracy.",)
    return Section("What the design saves", text, (energy_comparison(story.designed.alternatives, task.AXES),))


def _reached(story: Story) -> Section:
    before, after = story.versions[1], story.versions[-1]
    text = (
        "Standard deviations speak of noise alone. Before the missing effect is in the model the actual errors (the"
        " truth is known here) are many times larger; afterwards they are what the standard deviations say, and these"
        " are as small as was asked.",
    )
    blocks: list[Table | Plot] = [] if after is before else [estimate_table(before)]
    blocks += [estimate_table(after), accuracy(story.accuracy(after))]
    truth = replace(story.plain(after), theta=task.true_parameters())
    named = [("after the first experiment", story.versions[0]), ("in the end", after)]
    models = [(name, story.plain(model)) for name, model in named]
    positions = [(position,) for position in task.FIRST_POSITIONS]
    blocks.append(gain_accuracy(models, positions, OMEGA, task.AXES, truth))
    return Section("Asked and reached, before and after", text, tuple(blocks))
