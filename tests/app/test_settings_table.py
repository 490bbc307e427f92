"""The table of settings in the documentation is that of the code."""

from app import settings_table
from app.settings import Settings


def test_the_page_has_the_table_of_now() -> None:
    assert settings_table.main(["--check"]) == 0, "run python -m app.settings_table"


def test_every_setting_is_in_it_with_its_bounds() -> None:
    text = settings_table.table()
    assert text.count("`LPV_OED_") == len(Settings.model_fields)
    assert "| `LPV_OED_PORT` | `8000` | port to listen on (≥ 0, ≤ 65535) |" in text
    assert all(field.description for field in Settings.model_fields.values())
