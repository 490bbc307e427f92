"""Numbers carry the digits that they are worth, and no failure looks like a number."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.report.numbers import estimate, percent, point_label, probability, significant, weight


@pytest.mark.parametrize(
    ("value", "digits", "text"),
    [
        (1657.1718, 4, "1657"),
        (1657.1718, 3, "1657"),
        (0.00033333, 3, "0.000333"),
        (9.996, 3, "10.0"),
        (0.0, 3, "0"),
        (-0.5, 2, "−0.50"),
        (5.6e-8, 2, "5.6·10⁻⁸"),
        (1.5e12, 2, "1.5·10¹²"),
        (float("nan"), 3, "–"),
        (float("inf"), 3, "–"),
    ],
)
def test_significant_digits(value: float, digits: int, text: str) -> None:
    assert significant(value, digits) == text


@given(st.floats(min_value=1e-4, max_value=9e5), st.integers(1, 6))
def test_the_text_is_the_number_to_its_digits(value: float, digits: int) -> None:
    assert float(significant(value, digits)) == pytest.approx(value, rel=0.5000001 * 10.0 ** (1 - digits))


@pytest.mark.parametrize(
    ("value", "deviation", "text"),
    [
        (-0.900243, 0.000482, "−0.90024 ± 0.00048"),
        (10.0098, 0.0213, "10.010 ± 0.021"),
        (1234.5, 99.6, "1234 ± 100"),
        (1.0, 0.0996, "1.00 ± 0.10"),
        (2.0, float("inf"), "2.00"),
        (3.924e-6, 1.2e-7, "(3.92 ± 0.12)·10⁻⁶"),
    ],
)
def test_an_estimate_ends_where_its_deviation_ends(value: float, deviation: float, text: str) -> None:
    assert estimate(value, deviation) == text


def test_shares_and_operating_points() -> None:
    assert percent(0.9728) == "97.3 %"
    assert [weight(share) for share in (0.0, 0.0213, 1.0)] == ["< 0.1 %", "2.1 %", "> 99.9 %"]
    assert [probability(p) for p in (0.0, 0.0213)] == ["< 10⁻³⁰⁰", "0.021"]
    assert point_label((1.5, -2.0), ("v", "load"), ("m/s", "")) == "v = 1.5 m/s, load = −2"
