"""Every figure of the example of [Ghosh2018, Section 5] through a real server: python benchmarks/paper_example_http.py

Prints a table of what the paper has and what was found, with the certified gap and the time from request to answer,
and writes the same as JSON. Ends with an error when a figure is further than 0.1 % from that of the paper.
"""

import argparse
import json
import sys
import tempfile
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from tests.support.api import Api, Json
from tests.support.paper import FIGURES, Figure, energies, prepared
from tests.support.server import running_server

TOLERANCE = 1e-3
COLUMNS = "{:<22} {:>10} {:>10} {:>9} {:>9} {:>8}  {}"


def measured(api: Api, figure: Figure, plant: Json, model: Json) -> Json:
    began = time.perf_counter()
    design = api.made("/designs", figure.body(plant, model))
    return {
        "name": figure.name,
        "paper": figure.energy,
        "found": design["totalEnergy"],
        "difference": design["totalEnergy"] / figure.energy - 1,
        "lowerBound": design["lowerBound"],
        "gap": design["gap"],
        "seconds": time.perf_counter() - began,
        "energies": [{"operatingPoint": p, "energy": e} for p, e in energies(design).items()],
        "samples": design["samples"],
    }


def line(result: Json) -> str:
    where = ", ".join(f"{e['operatingPoint']:g}: {e['energy']:.0f}" for e in result["energies"])
    numbers = (f"{result['paper']:.1f}", f"{result['found']:.1f}", f"{100 * result['difference']:+.3f} %")
    return COLUMNS.format(result["name"], *numbers, f"{result['gap']:.1e}", f"{result['seconds']:.2f} s", where)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--output", type=Path, default=Path("paper_example_http.json"), help="where to write the JSON")
    output = parser.parse_args().output
    with tempfile.TemporaryDirectory() as folder, running_server(Path(folder) / "data") as server:
        api = Api(server.url)
        plant, model = prepared(api)
        measured(api, FIGURES[0], plant, model)  # the first job of a server also loads the libraries
        print(COLUMNS.format("design", "paper", "found", "", "gap", "time", "energy at operating points"))
        results = []
        for figure in FIGURES:
            results.append(measured(api, figure, plant, model))
            print(line(results[-1]), flush=True)
    output.write_text(json.dumps(results, indent=2) + "\n", encoding="utf-8")
    print(f"written to {output}")
    return int(any(abs(result["difference"]) > TOLERANCE for result in results))


if __name__ == "__main__":
    sys.exit(main())
