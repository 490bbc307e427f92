"""Kills two servers, their children and PostgreSQL at random: python -m benchmarks.kill_cluster [--help].

Two real servers share a PostgreSQL and a folder, on loopback. Experiments and designs are sent to either of them under
idempotency keys, again until they are answered, while at random moments a server, one process of a job, or the whole
PostgreSQL gets SIGKILL and is started again. In the end every acknowledged job must have succeeded and made exactly one
resource. Redone work is the share of runs that were not the first of their job. Prints what was found as JSON.
"""

import argparse
import json
import os
import signal
import sys
import tempfile
import time
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import httpx
import numpy as np

from benchmarks.kill_restart import COLLECTIONS, DESIGN, MODEL, PLANT, processes_on
from tests.support.patience import PATIENCE, until
from tests.support.postgres import Postgres, running_postgres
from tests.support.server import Server, start_server

VICTIMS = {"server": 0.4, "child": 0.45, "database": 0.15}
SUBMISSIONS_PER_KILL = 4
LONGEST_PAUSE_SECONDS = 1.5
LEASE_SECONDS = 3.0


@dataclass
class Cluster:
    """Two servers on one database, and what they have acknowledged."""

    directory: Path
    postgres: Postgres
    generator: np.random.Generator
    settings: dict[str, str]
    servers: list[Server] = field(default_factory=list)
    acknowledged: dict[str, str] = field(default_factory=dict)
    killed: Counter[str] = field(default_factory=Counter)
    seconds_to_health: list[float] = field(default_factory=list)
    plant: str = ""
    model: str = ""

    def prepare(self) -> None:
        """Start both servers; make the plant and a stated model."""
        self.servers = [start_server(self.directory, self.settings) for _ in range(2)]
        for server in self.servers:
            server.wait_until_healthy()
        with httpx.Client(base_url=self.servers[0].url, timeout=PATIENCE) as client:
            self.plant = client.post("/v1/plants", json=PLANT).raise_for_status().json()["id"]
            stated = MODEL | {"plantId": self.plant}
            self.model = client.post("/v1/models/stated", json=stated).raise_for_status().json()["id"]

    def strike(self, number: int) -> None:
        """Send some work, wait a moment, kill something, and start it again."""
        for index in range(int(self.generator.integers(1, SUBMISSIONS_PER_KILL + 1))):
            self._submit(f"strike {number} request {index}")
        time.sleep(self.generator.uniform(0.0, LONGEST_PAUSE_SECONDS))
        victim = str(self.generator.choice(list(VICTIMS), p=list(VICTIMS.values())))
        self.killed[victim] += {"server": self._server, "child": self._child, "database": self._database}[victim]()

    def finish(self) -> dict[str, Any]:
        """Wait until all work is done; then check the books, and that no process is left at the end."""
        try:
            with httpx.Client(base_url=self.servers[1].url, timeout=PATIENCE) as client:
                until(lambda: _is_done(client), "the end of all jobs", between=0.5)
                report = self._books(client)
        finally:
            for server in self.servers:
                server.stop()
        left = until(lambda: not list(processes_on(self.directory)), "the end of all processes")
        return report | {"killed": dict(self.killed), "noProcessLeft": left, **self._health()}

    def _submit(self, key: str) -> None:
        path, body = ("designs", DESIGN | {"modelId": self.model}) if self.generator.random() < 0.4 else self._record()
        place = int(self.generator.integers(2))

        def answered() -> str | None:
            try:
                url = f"{self.servers[place].url}/v1/{path}"
                headers = {"Idempotency-Key": key}
                answer = httpx.post(url, json=body | {"plantId": self.plant}, headers=headers, timeout=PATIENCE)
            except httpx.TransportError:
                return None
            if answer.status_code == 503:
                return None
            return str(answer.raise_for_status().json()["id"])

        self.acknowledged[key] = str(until(answered, key, between=0.1))

    def _record(self) -> tuple[str, dict[str, Any]]:
        u, y = self.generator.standard_normal((2, 1000))
        record = {"input": u.tolist(), "output": y.tolist(), "operatingPoint": [self.generator.random()]}
        return "experiments", record | {"kind": "timeRecord", "sampleTimeSeconds": 1.0}

    def _server(self) -> int:
        place = int(self.generator.integers(2))
        self.servers[place].kill()
        began = time.monotonic()
        self.servers[place] = start_server(self.directory, self.settings)
        self.servers[place].wait_until_healthy()
        self.seconds_to_health.append(time.monotonic() - began)
        return 1

    def _child(self) -> int:
        own = {server.process.pid for server in self.servers}
        children = sorted(pid for pid in processes_on(self.directory) if pid not in own)
        if not children:
            return 0
        try:
            os.kill(int(self.generator.choice(children)), signal.SIGKILL)
        except ProcessLookupError:
            return 0
        return 1

    def _database(self) -> int:
        self.postgres.stop(signal.SIGKILL)
        time.sleep(self.generator.uniform(0.0, 1.0))
        self.postgres.start()
        return 1

    def _books(self, client: httpx.Client) -> dict[str, Any]:
        jobs = {job["id"]: job for job in _all(client, "jobs")}
        per_job = Counter(made["jobId"] for collection in COLLECTIONS for made in _all(client, collection))
        acknowledged = set(self.acknowledged.values())
        succeeded = {identifier for identifier, job in jobs.items() if job["state"] == "succeeded"}
        runs = sum(job["attempts"] for job in jobs.values())
        return {
            "acknowledged": len(acknowledged),
            "lost": sorted(acknowledged - succeeded),
            "unasked": sorted(jobs.keys() - acknowledged),
            "madeTwice": sorted(job for job, count in per_job.items() if count != 1),
            "withoutResource": sorted(acknowledged - per_job.keys()),
            "redoneShare": round((runs - len(jobs)) / max(runs, 1), 4),
            "mostAttempts": max(job["attempts"] for job in jobs.values()),
        }

    def _health(self) -> dict[str, Any]:
        seconds = self.seconds_to_health or [0.0]
        return {"secondsToHealth": {"median": round(float(np.median(seconds)), 2), "largest": round(max(seconds), 2)}}


def _is_done(client: httpx.Client) -> bool:
    answers = [client.get("/v1/jobs", params={"state": state}) for state in ("queued", "running")]
    return all(answer.status_code == 200 and not answer.json()["items"] for answer in answers)


def _all(client: httpx.Client, collection: str) -> list[dict[str, Any]]:
    found: list[dict[str, Any]] = []
    query = {"limit": "500"}
    while True:
        page = client.get(f"/v1/{collection}", params=query).raise_for_status().json()
        found += page["items"]
        if "nextCursor" not in page:
            return found
        query["cursor"] = page["nextCursor"]


def run(kills: int, seed: int, directory: Path) -> dict[str, Any]:
    """Strike so many times; returns what was found."""
    began = time.monotonic()
    with running_postgres() as postgres:
        settings = {"LPV_OED_DATABASE_URL": postgres.database(), "LPV_OED_LEASE_SECONDS": str(LEASE_SECONDS)}
        cluster = Cluster(directory, postgres, np.random.default_rng(seed), settings | {"LPV_OED_WORKERS": "1"})
        cluster.prepare()
        for number in range(kills):
            cluster.strike(number)
        report = {"strikes": kills, "seed": seed, **cluster.finish()}
    return report | {"seconds": round(time.monotonic() - began, 1), "ok": is_good(report)}


def is_good(report: dict[str, Any]) -> bool:
    """Nothing lost, nothing made twice, no process left over."""
    bad = ("lost", "unasked", "madeTwice", "withoutResource")
    return report["acknowledged"] > 0 and report["noProcessLeft"] and not any(report[name] for name in bad)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--kills", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as directory:
        report = run(options.kills, options.seed, Path(directory) / "data")
    print(json.dumps(report, indent=2))
    return 0 if report["ok"] else 1


if __name__ == "__main__":
    sys.exit(main())
