"""Zahner Thales text exports: magnitude of the impedance and phase over frequency."""

from app.files.text_export import TextExport, spectrum


class ZahnerText(TextExport):
    """Impedance spectra as Thales and Zahner Analysis export them as text."""

    kind = "zahner"
    title = "Zahner text"
    endings = ("txt", "csv", "asc")
    phrases = ("impedance/ohm", "significance")

    @classmethod
    def example(cls) -> bytes:
        head = "Zahner Analysis: an example\n\n  Number    Frequency/Hz   Impedance/Ohm     Phase/deg  Significance\n"
        rows = [f"{k:8d}{f:16.6e}{z:16.6e}{-3.0 * k:16.6e}{0.99:8.3f}" for k, (f, _, _, z) in enumerate(spectrum())]
        return (head + "\n".join(rows) + "\n").encode("latin-1")
