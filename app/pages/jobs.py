"""Jobs: what is running, what has ended and how."""

from app.pages.page import Page

PAGES = (Page("/jobs", "jobs.html.j2", "Jobs", menu="service", place=2),)
