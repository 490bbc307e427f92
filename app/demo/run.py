"""The demonstration from beginning to end: told in the terminal, kept as a report."""

from pathlib import Path

import numpy as np
from rich.console import Console

from app.demo import task
from app.demo.charts import sparkline
from app.demo.laboratory import Laboratory
from app.demo.report import demo_report
from app.demo.story import Designed, Story, designed_second, energy_of, identified
from app.demo.tables import asked_table, effects_table, estimate_table, test_table
from app.demo.terminal import Terminal
from app.offline.loop import Loop
from app.offline.subjects import described_plant
from app.offline.workplace import Workplace, workplace
from app.report.chain.documents import Compared
from app.report.document import Table
from app.report.effect_text import amplitude
from app.report.numbers import percent, significant
from app.report.page import write
from app.schemas.diagnoses import Diagnosis
from app.schemas.models import Model
from app.schemas.plants import Plant, PlantRequest
from app.services.measured import Measured
from app.virtual_plant.campaign import PLANT
from app.virtual_plant.hidden import EFFECTS, Hidden
from app.virtual_plant.stage import Stage

STEPS = 8
SPARKS = 20
LEVEL = 0.05
UNIT = task.AXES.energy_unit


def run_demo(folder: Path, seed: int, console: Console, hidden: str = "cubic_stiffness") -> Path:
    """Walks the loop, writes report.html into the folder and returns its path."""
    folder.mkdir(parents=True, exist_ok=True)
    terminal = Terminal(console, STEPS)
    with workplace(console if console.is_terminal else Console(quiet=True)) as place:
        story = tell(seed, terminal, place, hidden)
        terminal.step("Report")
        path = write(demo_report(story), folder / "report.html")
    terminal.path(path, "Open it in a browser; it needs no network.")
    return path


def tell(seed: int, terminal: Terminal, place: Workplace, hidden: str = "cubic_stiffness") -> Story:
    """The story, told while it happens."""
    plant = described_plant(PlantRequest.model_validate(PLANT))
    lab = Laboratory(Stage(EFFECTS.get(hidden, Hidden())), np.random.default_rng(seed), place)
    _describe(terminal)
    first = lab.first()
    initial = _first(terminal, lab, plant, first)
    designed = _design(terminal, lab, plant, initial, energy_of(lab, first), seed)
    terminal.step("Play them, and identify from both experiments at once")
    second = lab.played(designed.played)
    held_out = lab.held_out()
    model = identified(place, plant, [*first, *second], "after both experiments")
    terminal.table(estimate_table(model))
    terminal.say(
        "The standard deviations are about those asked for. They speak of noise alone: the last column, which nobody"
        " knows on a real plant, is much larger than 1 σ where the model is wrong."
    )
    names = frozenset(one.id for one, _ in held_out)
    loop = Loop(place, plant, (*first, *second, *held_out), names)
    versions, compared, diagnosed = _improve(terminal, loop, model)
    story = Story(seed, hidden, designed, loop, (initial, *versions), tuple(compared), tuple(diagnosed))
    terminal.say(verdict(story))
    return story


def verdict(story: Story) -> str:
    """What was reached, in a few sentences."""
    errors = story.chain.steps()
    if not errors:
        return "Nothing was found missing that these experiments could show."
    before, after = errors[0].held_out or 0.0, errors[-1].held_out or 0.0
    names = ", ".join(one.title for one in story.versions[-1].effects)
    right = (
        "which is what the plant hides" if story.found == [story.hidden] else f"while the plant hides {story.hidden}"
    )
    return (
        f"Found and added: {names}, {right}. The error on held-out data fell from {percent(before)} to"
        f" {percent(after)}."
    )


def at_the_noise_floor(found: Diagnosis) -> bool:
    """Whether noise explains what is left, or no effect does."""
    return not found.announced or (found.lack_of_fit.p_value or 0.0) > LEVEL


def _describe(terminal: Terminal) -> None:
    terminal.title("lpv-oed: a positioning stage that is softer the farther out it stands")
    terminal.step("Describe the plant, and say how accurately it should be known")
    terminal.say(
        "Input: force (N); output: deflection (mm), with noise. Scheduling variable: position, 0 to 0.6 m. Structure:"
        " B/A with A = x² + a1 x + a2 and B = b0, x = jω/60; a2 is affine in the position. What the model does not"
        " know: the simulated stage does something else besides."
    )
    terminal.table(asked_table())


def _first(terminal: Terminal, lab: Laboratory, plant: Plant, first: list[Measured]) -> Model:
    terminal.step("A first experiment, not designed: weak multisines at three positions")
    initial = identified(lab.place, plant, first, "after the first experiment")
    terminal.table(estimate_table(initial))
    terminal.say(
        f"Input energy so far: {significant(energy_of(lab, first), 4)} {UNIT}. A second one has to bring the rest."
    )
    return initial


def _design(terminal: Terminal, lab: Laboratory, plant: Plant, initial: Model, energy: float, seed: int) -> Designed:
    terminal.step("Design the second: the least energy that brings the accuracy asked for")
    designed = designed_second(lab.place, plant, initial, energy, seed)
    found = designed.design
    terminal.table(_spectra_table(designed))
    bound, gap = significant(found.lower_bound or 0.0, 6), significant(found.gap or 0.0, 2)
    terminal.say(f"No design can need less than {bound} {UNIT}: certified to a relative gap of {gap}.")
    terminal.say("Energy that other ways would need for the same accuracy:")
    terminal.bars(designed.alternatives, UNIT)
    return designed


def _spectra_table(designed: Designed) -> Table:
    rows = []
    edges = np.geomspace(*task.BAND, SPARKS + 1)
    pairs = zip(designed.design.experiments, designed.played.document.signals, strict=True)
    for experiment, signal in pairs:
        omega, energies = np.array(signal.frequencies_rad_per_second), np.array(signal.achieved_energies)
        heights = np.histogram(omega, edges, weights=energies)[0]
        point = task.AXES.point(tuple(experiment.operating_point))
        rows.append((point, significant(experiment.energy, 4), sparkline(heights), significant(signal.crest_factor)))
    spectrum = f"{task.BAND[0]:g} to {task.BAND[1]:g} rad/s".center(SPARKS)
    return Table(("operating point", f"energy ({UNIT})", spectrum, "crest factor"), tuple(rows))


def _improve(terminal: Terminal, loop: Loop, model: Model) -> tuple[list[Model], list[Compared], list[Diagnosis]]:
    """Compare, diagnose, add, until nothing more is announced."""
    terminal.step("Hold the model against measurements, also where none was fitted")
    versions, compared, diagnosed = [model], [loop.compare(model)], []
    _show_comparison(terminal, loop, compared[-1])
    terminal.step("Ask which physical effect has the shape of the misfit")
    diagnosed.append(loop.diagnose(model))
    _show_diagnosis(terminal, diagnosed[-1])
    terminal.step("Add the best effect, fit everything again, and look again")
    while not at_the_noise_floor(diagnosed[-1]) and len(versions) <= task.MOST_EFFECTS:
        asked = {"effect": diagnosed[-1].announced[0], "diagnosisId": diagnosed[-1].id}
        versions.append(loop.extend(versions[-1], asked))
        compared.append(loop.compare(versions[-1]))
        diagnosed.append(loop.diagnose(versions[-1]))
        terminal.say(f"Added: {versions[-1].effects[-1].title}, {amplitude(versions[-1].effects[-1])}.")
        _show_comparison(terminal, loop, compared[-1])
        floor = at_the_noise_floor(diagnosed[-1])
        terminal.say("What is left is noise." if floor else f"Still missing: {', '.join(diagnosed[-1].announced)}.")
    _show_errors(terminal, loop, versions)
    terminal.table(estimate_table(versions[-1]))
    return versions, compared, diagnosed


def _show_comparison(terminal: Terminal, loop: Loop, compared: Compared) -> None:
    terminal.table(test_table(compared.document))
    terminal.map(loop.chain([], [], []).map_rows(compared), *task.BAND)


def _show_diagnosis(terminal: Terminal, found: Diagnosis) -> None:
    if not found.announced:
        terminal.say("No effect is announced.")
        return
    terminal.table(effects_table(found))
    if len(found.announced) > 1:
        names = ", ".join(found.announced)
        terminal.say(f"These experiments cannot tell them apart: {names}. The first has most weight.")


def _show_errors(terminal: Terminal, loop: Loop, versions: list[Model]) -> None:
    steps = loop.chain(versions, [], []).steps()
    if steps:
        terminal.say("Error on held-out data:")
        terminal.bars([(step.added, 100 * (step.held_out or 0.0)) for step in steps], "%")
