"""Experiments: bring data in, see what was understood of them."""

from app.pages.page import Page

PAGES = (
    Page("/plants/{plantId}/experiments", "experiments.html.j2", "Experiments", menu="plant", place=2),
    Page(
        "/plants/{plantId}/experiments/{experimentId}",
        "experiment.html.j2",
        "Experiment",
        under="/plants/{plantId}/experiments",
    ),
)
