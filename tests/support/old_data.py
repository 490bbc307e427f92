"""The data directory of an earlier version.

`tests/data/data_directory_of_c841d1c.tar.xz` was left by the service of that commit, killed with one job running and
one waiting: plants of every kind of structure, experiments still, as matrices and along p(t), models identified,
stated, extended, in state space and from varying scheduling, and one of every other resource.
"""

import tarfile
from pathlib import Path

KEPT = Path(__file__).resolve().parents[1] / "data" / "data_directory_of_c841d1c.tar.xz"


def unpacked(directory: Path) -> Path:
    """A copy of it."""
    with tarfile.open(KEPT) as kept:
        kept.extractall(directory, filter="data")
    return directory
