"""Which thread or process answers which shard."""

import threading
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import replace
from typing import Any

from colltrans.bulk.bodies import Bodies
from colltrans.bulk.shard import Job, Report, answer_shard
from colltrans.errors import ColltransError

Answer = Callable[..., Report]
#: Bodies of this process, by the object that they came with.
_CACHE: dict[str, Bodies] = {}


def local(
    jobs: list[Job],
    bodies: Bodies,
    workers: int,
    progress: Callable[[int], None] = lambda rows: None,
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
            futures = [pool.submit(answer_shard, job, bodies, told) for job in jobs]
            for future in as_completed(futures):
                yield future.result()
        finally:
            # Ctrl-C or a shard that cannot be read: the others end with the batch they are at.
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

    Files must be where every node finds them under the same name. The bodies of a table are built
    here, go once through the object store, and every worker keeps them; meshes are read by every
    worker. A task whose worker dies is done again.
    """
    import ray

    if not ray.is_initialized():
        here: dict[str, Any] = {"num_cpus": workers, "include_dashboard": False}
        here["object_store_memory"] = 256 << 20
        ray.init(address=address, log_to_driver=False, **({} if address else here))
    bodies.build_table()
    store = ray.put(bodies)

    def answer_with(job: Job, boxed: list[Any]) -> Report:
        return answer(job, _kept(boxed[0]))

    remote: Any = ray.remote(max_retries=5)
    task = remote(answer_with)
    waiting = [
        task.remote(replace(job, options=replace(job.options, threads=1)), [store]) for job in jobs
    ]
    while waiting:
        done, waiting = ray.wait(waiting)
        yield from ray.get(done)


def _kept(reference: Any) -> Bodies:
    """The bodies of a reference, fetched once in a worker."""
    import ray

    name = reference.hex()
    if name not in _CACHE:
        _CACHE[name] = ray.get(reference)
    return _CACHE[name]
