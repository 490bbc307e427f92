"""Runs of a study spread over processes, one thread of linear algebra in each; the same result for any number."""

import os
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from typing import TypeVar

import numpy as np

Result = TypeVar("Result")
Task = TypeVar("Task")


def spread(run: Callable[[np.random.SeedSequence], Result], runs: int, seed: int, workers: int) -> list[Result]:
    """`run` once for each of the independent seeds that `seed` spawns, in order."""
    for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
        os.environ[variable] = "1"
    with ProcessPoolExecutor(workers, mp_context=get_context("spawn")) as pool:
        return list(pool.map(run, np.random.SeedSequence(seed).spawn(runs), chunksize=5))


def over(run: Callable[[Task], Result], tasks: Sequence[Task], workers: int) -> list[Result]:
    """`run` of every task, in order."""
    for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
        os.environ[variable] = "1"
    with ProcessPoolExecutor(workers, mp_context=get_context("spawn")) as pool:
        return list(pool.map(run, tasks, chunksize=3))
