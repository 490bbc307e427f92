"""The bin: what was deleted, and the way back."""

from app.pages.page import Page

PAGES = (Page("/bin", "bin.html.j2", "Bin", menu="service", place=3),)
