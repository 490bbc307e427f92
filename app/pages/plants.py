"""Plants: the list, a new one, one of them."""

from app.pages.page import Page

PAGES = (
    Page("/plants", "plants.html.j2", "Plants", menu="service", place=1),
    Page("/plants/new", "plant_new.html.j2", "New plant", under="/plants"),
    Page("/plants/{plantId}", "plant.html.j2", "Overview", menu="plant", place=1),
)
