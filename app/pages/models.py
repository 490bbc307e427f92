"""Models: the list, one of them, and its versions."""

from app.pages.page import Page

PAGES = (
    Page("/plants/{plantId}/models", "models.html.j2", "Models", menu="plant", place=4),
    Page("/plants/{plantId}/models/{modelId}", "model.html.j2", "Model", under="/plants/{plantId}/models"),
    Page("/plants/{plantId}/history", "history.html.j2", "History", menu="plant", place=8),
)
