"""Settings come from the environment, and unsafe ones are refused."""

from pathlib import Path

import pytest
from pydantic import ValidationError

from app.settings import LEAST_JOB_MEMORY, Settings, is_loopback

TOKEN = "0123456789abcdef"


@pytest.mark.parametrize("host", ["0.0.0.0", "::", "192.0.2.7", "plant.example"])
def test_beyond_loopback_a_token_is_required(host: str) -> None:
    with pytest.raises(ValidationError, match="LPV_OED_TOKEN"):
        Settings(host=host)
    with pytest.raises(ValidationError, match="LPV_OED_TOKEN"):
        Settings(host=host, token="")
    assert Settings(host=host, token=TOKEN).bearer_token == TOKEN


@pytest.mark.parametrize("host", ["127.0.0.1", "127.8.9.1", "::1", "[::1]", "localhost", "Localhost"])
def test_loopback_needs_no_token(host: str) -> None:
    assert is_loopback(host)
    assert Settings(host=host).bearer_token is None


def test_settings_come_from_the_environment(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("LPV_OED_DATA_DIR", str(tmp_path / "a b%"))
    monkeypatch.setenv("LPV_OED_TOKEN", TOKEN)
    monkeypatch.setenv("LPV_OED_WORKERS", "3")
    monkeypatch.setenv("LPV_OED_TASK_PACKAGES", '["one", "two"]')
    settings = Settings()
    assert settings.workers == 3
    assert settings.task_packages == ("one", "two")
    assert settings.resolved_database_url == f"sqlite:///{tmp_path / 'a b%' / 'lpv-oed.sqlite'}"
    assert TOKEN not in repr(settings)


@pytest.mark.parametrize("url", ["mysql://h/d", "h"])
def test_a_database_of_another_kind_is_refused(url: str) -> None:
    with pytest.raises(ValidationError, match="postgresql://"):
        Settings(database_url=url)


def test_a_database_without_its_driver_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("app.settings.find_spec", lambda name: None)
    with pytest.raises(ValidationError, match=r"lpv-oed\[postgresql\]"):
        Settings(database_url="postgresql://h/d")


def test_another_database_is_a_setting() -> None:
    pytest.importorskip("psycopg")
    assert Settings(database_url="postgresql://h/d").resolved_database_url == "postgresql://h/d"


@pytest.mark.parametrize(
    "bad",
    [
        {"workers": 0},
        {"port": 70000},
        {"job_time_limit_seconds": 0},
        {"max_body_bytes": 1},
        {"job_memory_limit_bytes": LEAST_JOB_MEMORY - 1},
    ],
)
def test_senseless_settings_are_refused(bad: dict[str, int]) -> None:
    with pytest.raises(ValidationError):
        Settings(**bad)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    "bad", ["", " ", "a", "x" * 15, "x" * 16 + " ", " " * 20, "ü" * 20, "one two three four", "x" * 16 + "\n"]
)
def test_tokens_that_are_guessed_or_cannot_be_sent_are_refused(bad: str) -> None:
    with pytest.raises(ValidationError, match="16 letters"):
        Settings(token=bad)
