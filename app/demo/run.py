"""The demonstration from beginning to end: told in the terminal, kept as a report."""

from pathlib import Path

import numpy as np
from rich.console import Console

from app.demo import task
from app.demo.charts import sparkline
from app.demo.plant import AirHeater
from app.demo.report import demo_report
from app.demo.story import (
    Campaign,
    DesignedSecond,
    Story,
    final_model,
    first_experiment,
    first_model,
    second_design,
    second_experiment,
    signals_to_play,
)
from app.demo.tables import asked_table, estimate_table
from app.demo.terminal import Terminal
from app.report.document import Table
from app.report.figures.accuracy import accuracy_table
from app.report.figures.convergence import certificate_table
from app.report.figures.signals import signal_table
from app.report.numbers import percent, significant
from app.report.page import write
from identification.estimates import LpvEstimate
from identification.signals import OperatingPoint
from oed.design import Design
from oed.realisation import RealisedSignal

STEPS = 7
SPARKS = 32


def run_demo(folder: Path, seed: int, console: Console) -> Path:
    """Walks the loop, writes report.html into the folder and returns its path."""
    folder.mkdir(parents=True, exist_ok=True)
    terminal = Terminal(console, STEPS)
    story = tell(seed, terminal)
    terminal.step("Report")
    path = write(demo_report(story), folder / "report.html")
    terminal.path(path, "Open it in a browser; it needs no network.")
    return path


def tell(seed: int, terminal: Terminal) -> Story:
    """The story, told while it happens."""
    generator, plant = np.random.default_rng(seed), AirHeater()
    _describe(terminal)
    first, initial = _first(terminal, plant, generator)
    designed = _design(terminal, first, initial)
    points = tuple(experiment.operating_point for experiment in designed.design.experiments)
    signals = _signals(terminal, designed.design, points, generator)
    second = _second(terminal, plant, designed.design, signals, generator)
    terminal.step("Identify from both experiments at once, and compare with what was asked")
    story = Story(seed, first, initial, designed, signals, second, final_model(first, second))
    terminal.table(accuracy_table(story.accuracy))
    terminal.say(verdict(story))
    return story


def verdict(story: Story) -> str:
    """What was reached, in a few sentences."""
    unit, share = task.AXES.energy_unit, story.worst_share
    met = "The model is as accurate as asked" if share <= 1 else "The model is not yet as accurate as asked"
    more = significant(story.designed.alternatives[-1][1], 4)
    return (
        f"{met}: in the worst direction of the parameter space σ is {percent(share)} of what was asked. The"
        f" second experiment took {significant(story.second.energy, 4)} {unit};"
        f" more of the first would have taken {more} {unit}."
    )


def _describe(terminal: Terminal) -> None:
    terminal.title("lpv-oed: an air heater in a duct, whose dynamics change with the air velocity")
    terminal.step("Describe the plant, and say how accurately it should be known")
    terminal.say(
        "Input: heater power (kW); output: outlet temperature (K); once a second. Scheduling variable: air velocity"
        " v, 0 to 8 m/s. Structure: A = 1 + a1 q⁻¹, B = b0 q⁻¹, D = 1 + d1 q⁻¹, each coefficient affine in v."
    )
    terminal.table(asked_table())


def _first(terminal: Terminal, plant: AirHeater, generator: np.random.Generator) -> tuple[Campaign, LpvEstimate]:
    terminal.step("A first experiment, not designed: random binary, at four velocities")
    with terminal.progress("measure and identify", len(task.FIRST_POINTS)) as heard:
        first = first_experiment(plant, generator, heard)
    initial = first_model(first)
    terminal.table(estimate_table(initial))
    energy = f"{significant(first.energy, 4)} {task.AXES.energy_unit}"
    terminal.say(f"Input energy so far: {energy}. A second experiment has to bring the rest.")
    return first, initial


def _design(terminal: Terminal, first: Campaign, initial: LpvEstimate) -> DesignedSecond:
    terminal.step("Design the second: the least energy that brings the accuracy asked for")
    with terminal.progress("solve", None) as heard:
        designed = second_design(first, initial, heard)
    terminal.table(_spectra_table(designed.design))
    terminal.table(certificate_table(designed.design, task.AXES, ("standard deviations",)))
    terminal.say("Energy that other ways would need for the same accuracy:")
    terminal.bars(designed.alternatives, task.AXES.energy_unit)
    return designed


def _spectra_table(designed: Design) -> Table:
    rows = []
    for experiment in designed.experiments:
        indices, energies = experiment.spectrum.line_energies(2 * SPARKS, task.SAMPLE_TIME)
        energies = energies[(indices > 0) & (indices <= SPARKS)]
        rows.append(
            (task.AXES.point(experiment.operating_point), significant(experiment.energy, 4), sparkline(energies))
        )
    return Table(
        ("operating point", f"energy ({task.AXES.energy_unit})", "spectrum, 0 to π rad/s".center(SPARKS)), tuple(rows)
    )


def _signals(
    terminal: Terminal, designed: Design, points: tuple[OperatingPoint, ...], generator: np.random.Generator
) -> tuple[RealisedSignal, ...]:
    terminal.step(f"Make signals of it: multisines within ±{task.AMPLITUDE_LIMIT:g} {task.AXES.input_unit}")
    with terminal.progress("optimise phases", len(points)) as heard:
        signals = signals_to_play(designed, generator, heard)
    terminal.table(signal_table(points, signals, task.AXES))
    return signals


def _second(
    terminal: Terminal,
    plant: AirHeater,
    designed: Design,
    signals: tuple[RealisedSignal, ...],
    generator: np.random.Generator,
) -> Campaign:
    terminal.step("Play them on the plant")
    with terminal.progress("measure and identify", len(signals)) as heard:
        second = second_experiment(plant, designed, signals, generator, heard)
    samples = sum(len(record) for record in second.records)
    terminal.say(f"{len(second.records)} experiments, {samples} samples.")
    return second
