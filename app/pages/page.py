"""What a page is; a module of this package that has PAGES is discovered."""

import pkgutil
from dataclasses import dataclass
from functools import cache
from importlib import import_module
from typing import Literal

import app.pages

Menu = Literal["service", "plant", "none"]


@dataclass(frozen=True)
class Page:
    """One page: the path of its route, its template and title, and where it stands in which menu.

    The path may have parameters in braces; scripts find their values in `context`. A page of no menu names the `path`
    of the page that it belongs `under`, which is then marked in the menu.
    """

    path: str
    template: str
    title: str
    menu: Menu = "none"
    place: int = 0
    under: str = ""


@cache
def pages() -> tuple[Page, ...]:
    """All pages, in the order of their places; fixed paths before those with parameters."""
    modules = [import_module(f"app.pages.{found.name}") for found in pkgutil.iter_modules(app.pages.__path__)]
    found = [page for module in modules for page in getattr(module, "PAGES", ())]
    return tuple(sorted(found, key=lambda page: ("{" in page.path, page.path.count("{"), page.place, page.path)))


def menu(which: Menu) -> tuple[Page, ...]:
    """The pages of one menu."""
    return tuple(sorted((page for page in pages() if page.menu == which), key=lambda page: page.place))
