"""Designs: what accuracy is asked for, and the experiments that reach it."""

from app.pages.page import Page

DESIGN = "/plants/{plantId}/design"
PAGES = (
    Page(DESIGN, "design.html.j2", "Design", menu="plant", place=7),
    Page(DESIGN + "/{designId}", "design_result.html.j2", "Design", under=DESIGN),
)
