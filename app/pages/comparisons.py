"""Comparisons and diagnoses: where a model fails, and what it lacks."""

from app.pages.page import Page

COMPARE, DIAGNOSE = "/plants/{plantId}/compare", "/plants/{plantId}/diagnose"
PAGES = (
    Page(COMPARE, "compare.html.j2", "Compare", menu="plant", place=5),
    Page(COMPARE + "/{comparisonId}", "comparison.html.j2", "Comparison", under=COMPARE),
    Page(DIAGNOSE, "diagnose.html.j2", "Diagnose", menu="plant", place=6),
    Page(DIAGNOSE + "/{diagnosisId}", "diagnosis.html.j2", "Diagnosis", under=DIAGNOSE),
)
