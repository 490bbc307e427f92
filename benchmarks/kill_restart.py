"""Kills a working server with SIGKILL at random moments: python -m benchmarks.kill_restart [--help].

A real server process on loopback gets experiments and designs, is killed, and is started again on the same data
directory. In the end every acknowledged job must have succeeded and made exactly one resource, whatever was killed.
Prints what was found as JSON, also to FILE; the exit code is 0 when nothing was lost, nothing was made twice
and every start was healthy in time.
"""

import argparse
import json
import os
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import httpx
import numpy as np

from tests.support.patience import PATIENCE, until
from tests.support.server import Server, start_server

SECONDS_HEALTHY_AT_MOST = 3.0
LONGEST_LIFE_SECONDS = 2.5
SUBMISSIONS_PER_LIFE = 6
SECONDS_OF_GRACE = 120.0
BEFORE_HEALTHY = 0.1
DESIGNS = 0.25
COLLECTIONS = ("experiments", "designs")

PLANT: dict[str, Any] = {
    "name": "first order, gain over the range",
    "schedulingVariables": [{"name": "p", "minimum": 0.0, "maximum": 1.0}],
    "input": {"name": "u"},
    "output": {"name": "y"},
    "structure": {"timeDomain": "discrete", "sampleTimeSeconds": 1.0, "na": 1, "nb": 0, "nk": 1},
    "basis": {"factors": [{"kind": "polynomial", "degree": 1}]},
}
MODEL: dict[str, Any] = {"theta": [-0.8, 0.1, 1.0, 0.2], "noiseVariance": 1.0}
DESIGN: dict[str, Any] = {
    "operatingPoints": {"kind": "gridAxes", "axes": [{"minimum": 0.0, "maximum": 1.0, "count": 9}]},
    "targets": [{"kind": "parameter_deviation", "standardDeviations": [0.01, 0.01, 0.02, 0.02]}],
    "spectrumFamily": {"kind": "lines", "samples": 256},
    "samples": 1024,
}


@dataclass(frozen=True)
class Submission:
    """A request to start a job, always sent under the same key."""

    key: str
    path: str
    body: dict[str, Any]


@dataclass
class Study:
    """Lives of a server on one data directory, and what it has acknowledged so far."""

    directory: Path
    generator: np.random.Generator
    acknowledged: dict[str, str] = field(default_factory=dict)
    unanswered: dict[str, Submission] = field(default_factory=dict)
    seconds_to_health: list[float] = field(default_factory=list)
    interrupted: int = 0
    children_left: int = 0
    plant: str = ""
    model: str = ""

    def prepare(self) -> None:
        """A first life in which the plant and a stated model are made."""
        server = self._start()
        with httpx.Client(base_url=server.url, timeout=PATIENCE) as client:
            self.plant = client.post("/v1/plants", json=PLANT).raise_for_status().json()["id"]
            stated = MODEL | {"plantId": self.plant}
            self.model = client.post("/v1/models/stated", json=stated).raise_for_status().json()["id"]
        self._kill(server)

    def live(self, number: int) -> None:
        """One life: start, submit, be killed at a random moment, now and then before the first answer."""
        if self.generator.random() < BEFORE_HEALTHY:
            server = start_server(self.directory)
            time.sleep(self.generator.uniform(0.0, SECONDS_HEALTHY_AT_MOST / 2))
            return self._kill(server)
        server = self._start()
        end = time.monotonic() + self.generator.uniform(0.0, LONGEST_LIFE_SECONDS)
        with httpx.Client(base_url=server.url, timeout=PATIENCE) as client:
            self.interrupted += self._running(client)
            for submission in self._requests(number):
                if time.monotonic() < end:
                    self._submit(client, submission)
        time.sleep(max(0.0, end - time.monotonic()))
        self._kill(server)

    def finish(self) -> dict[str, Any]:
        """A last life in which all work is done and the books are checked."""
        server = self._start()
        try:
            with httpx.Client(base_url=server.url, timeout=PATIENCE) as client:
                for submission in list(self.unanswered.values()):
                    self._submit(client, submission)
                until(lambda: _is_done(client), "the end of all jobs", between=0.25)
                return self._books(client) | self._lives(server)
        finally:
            server.stop()

    def _start(self) -> Server:
        began = time.monotonic()
        server = start_server(self.directory)
        server.wait_until_healthy()
        self.seconds_to_health.append(time.monotonic() - began)
        return server

    def _kill(self, server: Server) -> None:
        server.kill()
        end = time.monotonic() + SECONDS_OF_GRACE
        while (left := list(processes_on(self.directory))) and time.monotonic() < end:
            time.sleep(0.05)
        self.children_left += len(left)

    def _running(self, client: httpx.Client) -> int:
        jobs = _all(client, "jobs")
        return sum(job["attempts"] > 1 and job["state"] == "running" for job in jobs)

    def _requests(self, number: int) -> Iterator[Submission]:
        yield from list(self.unanswered.values())
        for index in range(int(self.generator.integers(1, SUBMISSIONS_PER_LIFE + 1))):
            is_design = self.generator.random() < DESIGNS
            path, body = ("designs", self._design()) if is_design else ("experiments", self._experiment())
            time.sleep(self.generator.uniform(0.0, 0.1))
            yield Submission(f"life {number} request {index}", f"/v1/{path}", body | {"plantId": self.plant})

    def _design(self) -> dict[str, Any]:
        return DESIGN | {"modelId": self.model}

    def _experiment(self) -> dict[str, Any]:
        u, y = self.generator.standard_normal((2, 2000))
        record = {"input": u.tolist(), "output": y.tolist(), "operatingPoint": [self.generator.random()]}
        return record | {"kind": "timeRecord", "sampleTimeSeconds": 1.0}

    def _submit(self, client: httpx.Client, submission: Submission) -> None:
        self.unanswered[submission.key] = submission
        answer = client.post(submission.path, json=submission.body, headers={"Idempotency-Key": submission.key})
        answer.raise_for_status()
        self.acknowledged[submission.key] = answer.json()["id"]
        del self.unanswered[submission.key]

    def _books(self, client: httpx.Client) -> dict[str, Any]:
        jobs = {job["id"]: job for job in _all(client, "jobs")}
        made = [resource for collection in COLLECTIONS for resource in _all(client, collection)]
        per_job = Counter(resource["jobId"] for resource in made)
        acknowledged = set(self.acknowledged.values())
        succeeded = {identifier for identifier, job in jobs.items() if job["state"] == "succeeded"}
        results = {job["result"]["id"] for job in jobs.values() if "result" in job}
        return {
            "acknowledged": len(acknowledged),
            "succeeded": len(succeeded),
            "lost": sorted(acknowledged - succeeded),
            "unasked": sorted(jobs.keys() - acknowledged),
            "madeTwice": sorted(job for job, count in per_job.items() if count != 1),
            "resourcesWithoutJob": sorted({resource["id"] for resource in made} ^ results),
            "unreadableData": [i for i in _identifiers(made, "understood") if _unreadable(client, i)],
            "states": dict(Counter(job["state"] for job in jobs.values())),
            "mostAttempts": max((job["attempts"] for job in jobs.values()), default=0),
        }

    def _lives(self, server: Server) -> dict[str, Any]:
        seconds = self.seconds_to_health
        return {
            "startsMeasured": len(seconds),
            "secondsToHealth": {
                "median": round(float(np.median(seconds)), 3),
                "largest": round(max(seconds), 3),
            },
            "lateStarts": [round(s, 3) for s in seconds if s > SECONDS_HEALTHY_AT_MOST],
            "runsSeenAgainAfterKill": self.interrupted,
            "childrenLeftAfterKill": self.children_left,
        }


def _all(client: httpx.Client, collection: str) -> list[dict[str, Any]]:
    found: list[dict[str, Any]] = []
    cursor: str | None = None
    while True:
        query = {"limit": "500"} | ({"cursor": cursor} if cursor else {})
        page = client.get(f"/v1/{collection}", params=query).raise_for_status().json()
        found += page["items"]
        cursor = page.get("nextCursor")
        if cursor is None:
            return found


def _is_done(client: httpx.Client) -> bool:
    return all(job["state"] not in ("queued", "running") for job in _all(client, "jobs"))


def _identifiers(resources: list[dict[str, Any]], field_name: str) -> list[str]:
    return [resource["id"] for resource in resources if field_name in resource]


def _unreadable(client: httpx.Client, experiment: str) -> bool:
    return client.get(f"/v1/experiments/{experiment}/data").status_code != 200


def processes_on(directory: Path) -> Iterator[int]:
    """Processes that were started for this data directory and still run."""
    wanted = f"LPV_OED_DATA_DIR={directory}".encode()
    for entry in Path("/proc").iterdir():
        if entry.name.isdigit() and int(entry.name) != os.getpid():
            try:
                if wanted in (entry / "environ").read_bytes().split(b"\0"):
                    yield int(entry.name)
            except OSError:
                continue


def run(kills: int, seed: int, directory: Path) -> dict[str, Any]:
    """Kill a server so many times; returns what was found."""
    began = time.monotonic()
    study = Study(directory, np.random.default_rng(seed))
    study.prepare()
    for number in range(1, kills):
        study.live(number)
    report = {"kills": kills, "seed": seed, **study.finish()}
    in_time = not report["lateStarts"]
    return report | {"seconds": round(time.monotonic() - began, 1), "ok": is_good(report), "healthyInTime": in_time}


def is_good(report: dict[str, Any]) -> bool:
    """Nothing lost, nothing made twice, no process left over."""
    bad = ("lost", "unasked", "madeTwice", "resourcesWithoutJob", "unreadableData", "childrenLeftAfterKill")
    return report["acknowledged"] > 0 and not any(report[name] for name in bad)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--kills", type=int, default=50)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("file", type=Path, nargs="?", help="where to write the report as well")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as directory:
        report = run(options.kills, options.seed, Path(directory) / "data")
    text = json.dumps(report, indent=2)
    print(text)
    if options.file is not None:
        options.file.write_text(text + "\n", encoding="utf-8")
    return 0 if report["ok"] and report["healthyInTime"] else 1


if __name__ == "__main__":
    sys.exit(main())
