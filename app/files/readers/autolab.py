"""Autolab NOVA text exports: Z', −Z'', Z and −Phase with units in the header, separated by semicolons."""

from app.files.text_export import TextExport, spectrum


class AutolabText(TextExport):
    """Impedance spectra as NOVA exports them as ASCII."""

    kind = "autolab"
    title = "Autolab text"
    endings = ("txt", "csv")
    phrases = ("-z'' (ω)", "-phase (°)")

    @classmethod
    def example(cls) -> bytes:
        head = "Index;Frequency (Hz);Z' (Ω);-Z'' (Ω);Z (Ω);-Phase (°);Time (s)"
        rows = [f"{k};{f:.6f};{re:.6f};{im:.6f};{z:.6f};0;1.5" for k, (f, re, im, z) in enumerate(spectrum())]
        return "\n".join([head, *rows, ""]).encode()
