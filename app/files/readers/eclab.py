"""EC-Lab text exports (.mpt) of Bio-Logic: a counted preamble, then columns such as -Im(Z)/Ohm."""

from app.files.text_export import TextExport, spectrum


class EcLabText(TextExport):
    """Impedance spectra and records as EC-Lab exports them."""

    kind = "eclab"
    title = "EC-Lab text"
    endings = ("mpt", "txt")
    phrases = ("ec-lab ascii file",)

    @classmethod
    def example(cls) -> bytes:
        head = [
            "EC-Lab ASCII FILE",
            "Nb header lines : 6",
            "Potentio Electrochemical Impedance Spectroscopy",
            "Ewe ctrl range : min = -2,50 V, max = 2,50 V",
            "",
            "freq/Hz\tRe(Z)/Ohm\t-Im(Z)/Ohm\t|Z|/Ohm\ttime/s\t<Ewe>/V\tcycle number",
        ]
        lines = ["\t".join(f"{value:.7E}" for value in (*row, 1.5, 3.7, 1)).replace(".", ",") for row in spectrum()]
        return "\r\n".join([*head, *lines, ""]).encode("latin-1")
