"""ZView and ZPlot files (.z) of Scribner for Solartron instruments: Z' and Z'' in ohm behind "End Comments"."""

from app.files.contents import Table
from app.files.text_export import TextExport, renamed, spectrum


class ZViewFile(TextExport):
    """Impedance spectra as ZPlot and ZView write them."""

    kind = "zview"
    title = "ZView file"
    endings = ("z", "zpw", "txt")
    phrases = ("zplot", "zview", "z'(a)")

    @classmethod
    def known(cls, table: Table) -> Table:
        return renamed(table, {"Z'(a)": ("Z'", "Ohm"), "Z''(b)": ("Z''", "Ohm"), "Ampl": ("AC amplitude", "V")})

    @classmethod
    def example(cls) -> bytes:
        names = "  Freq(Hz)\tAmpl\tBias\tTime(Sec)\tZ'(a)\tZ''(b)\tGD\tErr\tRange"
        rows = [f"{f:.5E}\t0\t0\t1.5\t{re:.5E}\t{-im:.5E}\t0.0\t0\t0" for f, re, im, _ in spectrum()]
        return "\r\n".join(["ZPLOT2 ASCII", "", names, "End Comments", *rows, ""]).encode("latin-1")
