"""PalmSens PSTrace exports: CSV in UTF-16 with a date above and "neg. Phase / °" among the columns."""

from app.files.text_export import TextExport, spectrum


class PalmSensText(TextExport):
    """Impedance spectra as PSTrace exports them as CSV."""

    kind = "palmsens"
    title = "PalmSens text"
    endings = ("csv", "txt")
    phrases = ("neg. phase / °",)

    @classmethod
    def example(cls) -> bytes:
        head = ["Date and time:,2024-03-01 12:00:00", "Notes:,an example", "", "an example,,,,,"]
        names = "freq / Hz,neg. Phase / °,Idc / uA,Z / ohm,Z' / ohm,-Z'' / ohm"
        rows = [f"{f:.6f},0,0.1,{z:.6f},{re:.6f},{im:.6f}" for f, re, im, z in spectrum()]
        return "\r\n".join([*head, names, *rows, ""]).encode("utf-16")
