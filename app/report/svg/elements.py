"""Elements as text, escaped; and how wide a text will be."""

from collections.abc import Sequence
from html import escape

from app.report.numbers import superscript

SIZE = 12.5
LINE = 15.0
WIDTH_OF_LETTER = 0.56


def element(tag: str, content: str = "", /, **attributes: object) -> str:
    """An element; underscores in names of attributes stand for hyphens, None leaves one out."""
    given = "".join(
        f' {name.rstrip("_").replace("_", "-")}="{escape(_text(value))}"'
        for name, value in attributes.items()
        if value is not None
    )
    return f"<{tag}{given}>{content}</{tag}>" if content else f"<{tag}{given}/>"


def text(x: float, y: float, lines: Sequence[str], anchor: str = "middle", **attributes: object) -> str:
    """Lines of text, the baseline of the first at y."""
    if len(lines) == 1:
        return element("text", escape(lines[0]), x=x, y=y, text_anchor=anchor, **attributes)
    spans = "".join(element("tspan", escape(line), x=x, y=y + i * LINE) for i, line in enumerate(lines))
    return element("text", spans, text_anchor=anchor, **attributes)


def lines_of(label: object) -> list[str]:
    """The lines of a label of plotly, whose breaks are marks."""
    return str(label).split("<br>")


def width_of(label: object) -> float:
    """The width of a label in pixels, roughly."""
    return WIDTH_OF_LETTER * SIZE * max(len(line) for line in lines_of(label))


def number_label(value: float) -> str:
    """A number as it stands at an axis."""
    if value != 0 and not 1e-3 <= abs(value) < 1e6:
        mantissa, exponent = f"{value:.3e}".split("e")
        digits = f"{float(mantissa):g}"
        power = f"10{superscript(int(exponent))}"
        return {"1": power, "-1": f"-{power}"}.get(digits, f"{digits}·{power}").replace("-", "−")
    return f"{value:.6g}".replace("-", "−")


def _text(value: object) -> str:
    return f"{value:.1f}".removesuffix(".0") if isinstance(value, float) else str(value)
