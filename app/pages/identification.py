"""Identification: a model from experiments."""

from app.pages.page import Page

PAGES = (Page("/plants/{plantId}/identify", "identify.html.j2", "Identify", menu="plant", place=3),)
