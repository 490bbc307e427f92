"""Scripts, styles and pictures of the pages, and plotly.js from the installed package."""

import hashlib
import importlib.util
from dataclasses import dataclass
from functools import cache
from importlib import metadata
from pathlib import Path

import app

FOLDER = Path(app.__file__).parent / "static"
MEDIA_TYPES = {".js": "text/javascript; charset=utf-8", ".css": "text/css; charset=utf-8", ".svg": "image/svg+xml"}


@dataclass(frozen=True)
class Assets:
    """Contents and media types by their paths below the folder; `version` changes with any of the contents."""

    files: dict[str, tuple[bytes, str]]
    version: str

    @property
    def prefix(self) -> str:
        """What addresses of these files begin with."""
        return f"/static/{self.version}"


@cache
def assets() -> Assets:
    """All files of the folder, read once; only these can be asked for."""
    paths = sorted(path for path in FOLDER.rglob("*") if path.suffix in MEDIA_TYPES)
    files = {path.relative_to(FOLDER).as_posix(): (path.read_bytes(), MEDIA_TYPES[path.suffix]) for path in paths}
    digest = hashlib.sha256(b"".join(name.encode() + content for name, (content, _) in files.items()))
    return Assets(files, digest.hexdigest()[:16])


@cache
def plotly_address() -> str:
    """Where plotly.js is served; changes with its version."""
    return f"/static/plotly-{metadata.version('plotly')}/plotly.min.js"


@cache
def plotly_file() -> Path:
    """plotly.js of the installed package, found without loading the package."""
    specification = importlib.util.find_spec("plotly")
    origin = specification.origin if specification else None
    assert origin is not None, "plotly is a dependency"
    return Path(origin).parent / "package_data" / "plotly.min.js"
