"""Every structure walks the loop as README's table says: each cell works, or the service says what is against it."""

import pytest

from tests.support.api import Api
from tests.support.loop_plants import PLANTS
from tests.support.loop_table import kept, table
from tests.support.loop_walk import STEPS, Walk
from tests.support.server import Server


@pytest.fixture(scope="module")
def found(server: Server) -> dict[str, dict[tuple[bool, str], str]]:
    api = Api(server.url)
    return {one.name: Walk(api, one).walked() for one in PLANTS}


def test_the_table_of_readme_is_what_works(found: dict[str, dict[tuple[bool, str], str]]) -> None:
    assert table(found) == kept(), "python -m benchmarks.structure_table writes it"


@pytest.mark.parametrize("name", [one.name for one in PLANTS])
def test_no_cell_is_a_fault_of_the_service(found: dict[str, dict[tuple[bool, str], str]], name: str) -> None:
    assert set(found[name]) == {(grown, step) for grown in (False, True) for step in STEPS}
    for reason in found[name].values():
        assert "report the fault" not in reason
        assert "left the range of numbers" not in reason


@pytest.mark.parametrize("name", [one.name for one in PLANTS if not one.lists])
def test_rational_models_walk_every_step(found: dict[str, dict[tuple[bool, str], str]], name: str) -> None:
    assert [found[name][False, step] for step in STEPS] == [""] * len(STEPS)
    others = {step for step in STEPS if found[name][True, step] and "invisible" not in found[name][True, step]}
    assert others == {"identify"}
