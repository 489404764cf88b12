"""Which thread or process answers which shard.

A shard that cannot be read or written is a report with a failure, and the others go on.
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
#: Bodies of this process, by the object that they came with.
_CACHE: dict[str, Bodies] = {}


def attempt(answer: Answer, job: Job, *rest: Any) -> Report:
    """Returns the report of a shard. Whatever is raised, a panic included, is its failure."""
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
    """Shards on threads of this process, as they are done: the work is done without its lock.

    A shard has as many threads to itself as there are for each shard.
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
            # Ctrl-C: the others end with the batch they are at.
            stopped.set()
            pool.shutdown(wait=False, cancel_futures=True)


def ray(
    jobs: list[Job],
    bodies: Bodies,
    workers: int,
    address: str | None = None,
    answer: Answer = answer_shard,
) -> Iterator[Report]:
    """Shards as tasks of a Ray cluster, as they are done; here, if there is no address.

    Files must be where every node finds them under the same name. The table of bodies is read here
    and goes once through the object store, where all workers of a node read the same numbers; each
    builds the bodies that it needs, and keeps them. Meshes are read by every worker. A task whose
    worker dies is done again, up to five times.
    """
    import ray

    if not ray.is_initialized():
        here: dict[str, Any] = {"num_cpus": workers, "include_dashboard": False}
        here["object_store_memory"] = 256 << 20
        # Without an address Ray would take a cluster that it finds on this machine.
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
    """The bodies of a reference, fetched once in a worker."""
    import ray

    name = reference.hex()
    if name not in _CACHE:
        _CACHE[name] = ray.get(reference)
    return _CACHE[name]
