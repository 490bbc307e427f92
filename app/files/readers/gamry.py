"""Gamry .DTA files: tables behind a preamble, each with a line of units; impedances stand in ZCURVE."""

from app.files.text_export import TextExport, spectrum


class GamryFile(TextExport):
    """Impedance spectra and records as Gamry Framework writes them."""

    kind = "gamry"
    title = "Gamry DTA"
    endings = ("dta",)
    phrases = ("explain",)

    @classmethod
    def example(cls) -> bytes:
        head = "EXPLAIN\nTAG\tEISPOT\nTITLE\tLABEL\tan example\tTest &Identifier\nZCURVE\tTABLE\n"
        names = "\tPt\tTime\tFreq\tZreal\tZimag\tZsig\tZmod\n\t#\ts\tHz\tohm\tohm\tV\tohm\n"
        rows = [
            f"\t{k}\t{1.5 * k}\t{f:.6G}\t{re:.6G}\t{-im:.6G}\t1\t{z:.6G}" for k, (f, re, im, z) in enumerate(spectrum())
        ]
        return (head + names + "\n".join(rows) + "\n").encode("latin-1")
