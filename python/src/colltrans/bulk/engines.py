"""Distribution of shards to threads and processes.

A shard that cannot be read or written has a report with a failure; the others continue.
"""

import threading
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import replace
from typing import Any

from colltrans.bulk.bodies import Bodies
from colltrans.bulk.shard import Job, Report, answer_shard
from colltrans.errors import ColltransError, as_error

Answer = Callable[..., Report]
#: The bodies of this process, by the object reference that they came from.
_CACHE: dict[str, Bodies] = {}


def attempt(answer: Answer, job: Job, *rest: Any) -> Report:
    """Returns the report of a shard. Any exception, including a panic, becomes its failure."""
    try:
        return answer(job, *rest)
    except BaseException as error:
        return Report(job, failure=str(as_error(error, job.queries)))


def local(
    jobs: list[Job],
    bodies: Bodies,
    workers: int,
    progress: Callable[[int], None] = lambda rows: None,
    answer: Answer = answer_shard,
) -> Iterator[Report]:
    """Answers shards on threads of this process, without the interpreter's lock.

    Yields the reports as shards finish. If there are more threads than shards, each shard uses
    several.
    """
    stopped = threading.Event()

    def told(rows: int) -> None:
        if stopped.is_set():
            raise ColltransError("stopped")
        progress(rows)

    threads = max(1, workers // max(1, len(jobs)))
    jobs = [replace(job, options=replace(job.options, threads=threads)) for job in jobs]
    with ThreadPoolExecutor(max(1, min(workers, len(jobs)))) as pool:
        try:
            futures = [pool.submit(attempt, answer, job, bodies, told) for job in jobs]
            for future in as_completed(futures):
                yield future.result()
        finally:
            # After Ctrl-C the other shards end with their current batch.
            stopped.set()
            pool.shutdown(wait=False, cancel_futures=True)


def ray(
    jobs: list[Job],
    bodies: Bodies,
    workers: int,
    address: str | None = None,
    answer: Answer = answer_shard,
) -> Iterator[Report]:
    """Answers shards as tasks of a Ray cluster; without an address a local one is started.

    Yields the reports as shards finish. Every node must find the files under the same names. The
    table of bodies is read here and copied once to the object store, which all workers of a node
    share. Each worker builds and caches the bodies that it needs. Meshes are read by every worker.
    A task whose worker dies is repeated up to five times.
    """
    import ray

    if not ray.is_initialized():
        here: dict[str, Any] = {"num_cpus": workers, "include_dashboard": False}
        here["object_store_memory"] = 256 << 20
        # Without an address Ray would connect to a cluster that runs on this machine.
        ray.init(address=address or "local", log_to_driver=False, **({} if address else here))
    bodies.share()
    store = ray.put(bodies)

    def answer_with(job: Job, boxed: list[Any]) -> Report:
        return attempt(answer, job, _kept(boxed[0]))

    remote: Any = ray.remote(max_retries=5)
    task = remote(answer_with)
    asked = [replace(job, options=replace(job.options, threads=1)) for job in jobs]
    waiting = {task.remote(job, [store]): job for job in asked}
    while waiting:
        done, _ = ray.wait(list(waiting))
        for future in done:
            job = waiting.pop(future)
            try:
                yield ray.get(future)
            except ray.exceptions.RayError as error:
                yield Report(job, failure=f"{job.queries}: {error}")


def _kept(reference: Any) -> Bodies:
    """Returns the bodies of a reference, which a worker fetches once."""
    import ray

    name = reference.hex()
    if name not in _CACHE:
        _CACHE[name] = ray.get(reference)
    return _CACHE[name]
