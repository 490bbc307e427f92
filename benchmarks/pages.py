"""How soon pages are ready and how soon they answer: python -m benchmarks.pages --runs 5 [--chromium PATH].

A plant of 50 operating points with 1000 lines each on a real server. For every page, in a window of 1280 x 900
pixels: the seconds until all its data, texts, tables and maps are there and every plot in the window is drawn, in a
new browser profile (cold) and again in the same one (warm); the seconds until somebody who then scrolls from plot to
plot at once has seen all of them, as those below the window are drawn when they come near it; and the processor
seconds of the page until the first, which say more on a machine with other work. Then the milliseconds from a click
on a map of 50 000 cells to the next picture; and the milliseconds in which shells, scripts and the requests that
pages make are answered while as many jobs as there are cores keep these busy. Prints tables with the machine;
--output writes JSON, --pictures FOLDER a picture of every page in light and dark, at 1280 and 390 pixels.
"""

import argparse
import os
import platform
import re
import shutil
import tempfile
from collections.abc import Iterator
from pathlib import Path
from time import perf_counter
from typing import Any

import httpx
import numpy as np
from playwright.sync_api import Browser, sync_playwright

from app.pages.page import pages
from benchmarks.command import command_line, print_table, write_json
from tests.support.api import Api, Json
from tests.support.browser import DRAW_ALL, READY, Visit
from tests.support.server import running_server

POINTS, LINES = 50, 1000
PLANT: Json = {
    "name": "50 operating points, 1000 lines",
    "schedulingVariables": [{"name": "speed", "unit": "m/s", "minimum": 0.0, "maximum": 10.0}],
    "input": {"name": "force", "unit": "N"},
    "output": {"name": "way", "unit": "mm"},
    "structure": {"timeDomain": "continuous", "na": 2, "nb": 0, "frequencyScaleRadPerSecond": 10.0},
    "basis": {"factors": [{"kind": "polynomial", "degree": 1}]},
}
BUSY: Json = {"spectrumFamily": {"kind": "fir", "degree": 300}, "tolerance": 1e-8, "sampleTimeSeconds": 0.05}
MARK = """new MutationObserver(() => {
  if (document.body?.dataset.ready !== undefined) window.readyAt ??= performance.now();
}).observe(document, { subtree: true, childList: true, attributes: true, attributeFilter: ["data-ready"] })"""
CLICK = """async () => {
  const { FieldMap } = await import(document.querySelector('script[src*="/js/shell.js"]').src.replace("shell", "map"));
  const frequencies = Array.from({ length: 1000 }, (_, i) => 0.1 * 1.007 ** i);
  const rows = Array.from({ length: 50 }, (_, p) => ({
    label: `p = ${p}`, frequencies, values: frequencies.map((_, i) => Math.sin(i * p / 300)),
  }));
  const place = document.createElement("div");
  document.querySelector("main").append(place);
  const map = new FieldMap(place, { rows, minimum: -1, maximum: 1, caption: "", frequencyTitle: "", valueTitle: "",
    describe: (row, column) => `${row} ${column}` });
  const frame = () => new Promise(requestAnimationFrame);
  await frame();
  await frame();
  const times = [];
  for (let i = 0; i < 20; i += 1) {
    const began = performance.now();
    const { left, top } = map.canvas.getBoundingClientRect();
    map.canvas.dispatchEvent(new MouseEvent("click", { clientX: left + 200 + 20 * i, clientY: top + 40 + 10 * i }));
    await frame();
    times.push(performance.now() - began);
  }
  return times;
}"""


def machine() -> dict[str, Any]:
    """What the figures depend on."""
    model = re.search(r"model name\s*: (.*)", Path("/proc/cpuinfo").read_text())
    processor = model[1] if model else platform.machine()
    return {"processor": processor, "cores": os.cpu_count(), "load before": os.getloadavg()[0]}


def responses() -> Iterator[Json]:
    """Bodies of experiments: a resonance that moves with the speed, one per cent of noise."""
    generator, omega = np.random.default_rng(0), np.geomspace(0.3, 100.0, LINES)
    for speed in np.linspace(0, 10, POINTS):
        true = 100 / (100 + 8 * speed - omega**2 + 1j * omega * (2 + 0.1 * speed))
        sigma = 0.01 * abs(true)
        noise = sigma * (generator.standard_normal(LINES) + 1j * generator.standard_normal(LINES)) / np.sqrt(2)
        yield {
            "kind": "frequencyResponse",
            "operatingPoint": [float(speed)],
            "frequenciesRadPerSecond": omega.tolist(),
            "response": {"re": (true + noise).real.tolist(), "im": (true + noise).imag.tolist()},
            "variance": (sigma**2).tolist(),
        }


def prepared(api: Api) -> dict[str, str]:
    """Identifiers by the names of path parameters: a plant with all that pages show."""
    plant = api.post("/plants", PLANT)["id"]
    experiments = [api.made("/experiments", {**body, "plantId": plant})["id"] for body in responses()]
    estimators = {"localEstimator": {"kind": "rational_fit"}, "lpvEstimator": {"kind": "generalised_least_squares"}}
    model = api.made("/models", {"plantId": plant, "experimentIds": experiments, **estimators})["id"]
    compared = {"modelId": model, "experimentIds": experiments}
    comparison = api.made("/comparisons", compared)["id"]
    diagnosis = api.made("/diagnoses", {**compared, "effects": ["delay", "lag", "lead"]}, seconds=600)["id"]
    design = api.made("/designs", {**request(plant, model), "spectrumFamily": {"kind": "lines", "samples": 2000}})["id"]
    return {
        "plantId": plant,
        "experimentId": experiments[0],
        "modelId": model,
        "comparisonId": comparison,
        "diagnosisId": diagnosis,
        "designId": design,
    }


def request(plant: str, model: str) -> Json:
    """A design over all operating points."""
    target = {"operatingPoints": [[0.0], [5.0], [10.0]], "minimumRadPerSecond": 1.0, "maximumRadPerSecond": 30.0}
    axes = [{"minimum": 0.0, "maximum": 10.0, "count": POINTS}]
    return {
        "plantId": plant,
        "modelId": model,
        "operatingPoints": {"kind": "gridAxes", "axes": axes},
        "targets": [{"kind": "response_deviation", **target, "standardDeviation": 0.001}],
        "samples": 4000,
        "sampleTimeSeconds": 0.02,
    }


def paths(known: dict[str, str]) -> dict[str, str]:
    """Addresses of all pages by their titles and paths."""
    found = {}
    for page in pages():
        names = re.findall(r"\{(\w+)\}", page.path)
        if known.keys() >= set(names):
            found[page.path] = re.sub(r"\{(\w+)\}", lambda match: known[match[1]], page.path)
    return found


def seconds_until_ready(browser: Browser, url: str, runs: int) -> dict[str, float]:
    """Median and largest seconds, cold and warm, those until all plots are seen, and the page's processor seconds."""
    cold, warm, seen, processor = [], [], [], []
    for _ in range(runs):
        with browser.new_context(viewport={"width": 1280, "height": 900}) as context:
            context.add_init_script(MARK)
            for times in (cold, warm):
                page = context.new_page()
                session = context.new_cdp_session(page)
                session.send("Performance.enable", {"timeDomain": "threadTicks"})
                page.goto(url)
                page.wait_for_selector(READY, state="attached", timeout=60_000)
                metrics = {one["name"]: one["value"] for one in session.send("Performance.getMetrics")["metrics"]}
                processor.append(metrics["TaskDuration"])
                times.append(page.evaluate("readyAt") / 1000)
                page.evaluate(DRAW_ALL)
                seen.append(page.evaluate("performance.now()") / 1000)
                page.close()
    return {
        "cold s": float(np.median(cold)),
        "cold max s": max(cold),
        "warm s": float(np.median(warm)),
        "warm max s": max(warm),
        "all plots s": float(np.median(seen)),
        "processor s": float(np.median(processor)),
    }


def take_pictures(browser: Browser, url: str, known: dict[str, str], folder: Path) -> None:
    """Every page in light and dark, wide and narrow; raises AssertionError for errors on a page."""
    folder.mkdir(parents=True, exist_ok=True)
    with browser.new_context(base_url=url) as context:
        visit = Visit(context.new_page(), url)
        for name, path in paths(known).items():
            visit.open(path)
            visit.look(folder, re.sub(r"\W+", "-", name).strip("-"))
        assert visit.faults == []


def milliseconds_of_clicks(browser: Browser, url: str) -> dict[str, float]:
    """Clicks on a map of 50 000 cells."""
    with browser.new_context(base_url=url) as context:
        page = context.new_page()
        page.goto("/jobs")
        page.wait_for_selector(READY, state="attached")
        times = page.evaluate(CLICK)
    return {"median ms": float(np.median(times)), "max ms": max(times)}


def milliseconds_under_load(api: Api, known: dict[str, str], runs: int) -> list[dict[str, Any]]:
    """Answers to what pages ask for, while every core is busy with a job."""
    body = {**request(known["plantId"], known["modelId"]), **BUSY}
    busy = [api.post("/designs", {**body, "samples": 4000 + i}) for i in range(os.cpu_count() or 2)]
    while any(api.get(f"/jobs/{job['id']}")["state"] == "queued" for job in busy):
        pass
    addresses = {"shells": list(paths(known).values()), "scripts and styles": scripts(api), "requests": asked(known)}
    rows = []
    with httpx.Client(base_url=api.url, timeout=60) as client:
        for kind, group in addresses.items():
            times = [answered(client, group[i % len(group)]) for i in range(runs * 100)]
            quantile = float(np.quantile(times, 0.99))
            rows.append({"what": kind, "median ms": float(np.median(times)), "99 % ms": quantile, "max ms": max(times)})
    still = [api.get(f"/jobs/{job['id']}")["state"] for job in busy]
    assert still == ["running"] * len(busy), f"the jobs ended before the measurement did: {still}"
    for job in busy:
        api.post(f"/jobs/{job['id']}/cancellation", {})
    return rows


def answered(client: httpx.Client, address: str) -> float:
    began = perf_counter()
    answer = client.get(address)
    assert answer.status_code == 200, address
    return 1000 * (perf_counter() - began)


def scripts(api: Api) -> list[str]:
    return re.findall(r'(?:src|href)="(/static/[^"]+)"', httpx.get(f"{api.url}/plants").text)


def asked(known: dict[str, str]) -> list[str]:
    """What pages ask of /v1: lists and single documents."""
    plant = known["plantId"]
    lists = ("experiments?limit=500&", "models?", "designs?", "comparisons?", "diagnoses?")
    single = ("plants", "experiments", "models", "comparisons", "diagnoses", "designs")
    documents = [f"/v1/{kind}/{known[name]}" for kind, name in zip(single, known, strict=True)]
    return [f"/v1/{one}plantId={plant}" for one in lists] + documents + ["/v1/catalogue", "/v1/jobs?limit=200"]


def main(arguments: argparse.Namespace) -> None:
    """Measure, print, write."""
    found: dict[str, Any] = {"machine": machine()}
    print(found["machine"])
    with tempfile.TemporaryDirectory() as folder, running_server(Path(folder) / "data") as server:
        api = Api(server.url)
        known = prepared(api)
        with sync_playwright() as playwright:
            browser = playwright.chromium.launch(executable_path=arguments.chromium, args=["--no-sandbox"])
            found["ready"] = [
                {"page": name, **seconds_until_ready(browser, server.url + path, arguments.runs)}
                for name, path in paths(known).items()
            ]
            found["clicks"] = milliseconds_of_clicks(browser, server.url)
            if arguments.pictures:
                take_pictures(browser, server.url, known, arguments.pictures)
            browser.close()
        print_table(found["ready"])
        print_table([found["clicks"]])
        found["under load"] = milliseconds_under_load(api, known, arguments.runs)
    print_table(found["under load"])
    write_json(found, arguments.output)


if __name__ == "__main__":
    parser = command_line(__doc__ or "", runs=5)
    parser.add_argument("--chromium", default=shutil.which("chromium"), help="the browser (default %(default)s)")
    parser.add_argument("--pictures", type=Path, help="folder for pictures of all pages")
    main(parser.parse_args())
