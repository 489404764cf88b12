"""Distribution of tasks to threads and processes.

A task is a sequence of shards. Tasks are submitted as they are needed: the number of those that
wait or run is bounded. A shard that cannot be read or written has a report with a failure; the
others continue.
"""

import math
import threading
import time
from collections import OrderedDict
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from dataclasses import dataclass, replace
from typing import Any, TypeAlias

from colltrans.bulk.bodies import Bodies
from colltrans.bulk.shard import Job, Report, answer_shard
from colltrans.bulk.sources import Source
from colltrans.errors import ColltransError, InputError, as_error

Answerer: TypeAlias = Callable[..., Report]
Task: TypeAlias = Sequence[Job]
#: Maximum number of objects that a worker keeps of those that it fetched: bodies and footers.
KEPT = 8
#: Seconds after which the size of a cluster is requested again.
FRESH = 5.0
#: The objects that this process fetched, by their reference.
_KEPT: OrderedDict[str, Any] = OrderedDict()


@dataclass(frozen=True)
class Resources:
    """The resources of a task of Ray.

    Attributes
    ----------
    cpus : int
        Number of processors, and of threads.
    memory : int or None
        Number of bytes that the scheduler reserves; None for no reservation.
    in_flight : int or None
        Maximum number of tasks that wait or run; None for twice as many as the processors of the
        cluster can run.
    """

    cpus: int = 1
    memory: int | None = None
    in_flight: int | None = None

    def __post_init__(self) -> None:
        for name in ("cpus", "memory", "in_flight"):
            if (value := getattr(self, name)) is not None and value < 1:
                raise InputError(f"{name}: {value} is not a whole number from 1")


def attempt(answer: Answerer, job: Job, *rest: Any) -> Report:
    """Returns the report of a shard. Any exception, including a panic, becomes its failure."""
    try:
        return answer(job, *rest)
    except BaseException as error:
        told = as_error(error, job.queries)
        return Report(job, failure=str(told), error=type(told).__name__)


def local(
    tasks: Sequence[Task],
    bodies: Bodies,
    workers: int,
    progress: Callable[[int], None] = lambda rows: None,
    answer: Answerer = answer_shard,
) -> Iterator[Report]:
    """Answers shards on threads of this process, without the interpreter's lock.

    Yields the reports as tasks finish. If there are more threads than tasks, each shard uses
    several.
    """
    stopped = threading.Event()

    def told(rows: int) -> None:
        if stopped.is_set():
            raise ColltransError("stopped")
        progress(rows)

    threads = max(1, workers // max(1, len(tasks)))

    def run(task: Task) -> list[Report]:
        jobs = (replace(job, options=replace(job.options, threads=threads)) for job in task)
        return [attempt(answer, job, bodies, told) for job in jobs]

    with ThreadPoolExecutor(max(1, min(workers, len(tasks)))) as pool:
        try:
            waiting: set[Future[list[Report]]] = set()
            for task in tasks:
                while len(waiting) >= 2 * workers:
                    done, waiting = wait(waiting, return_when=FIRST_COMPLETED)
                    yield from _reports(done)
                waiting.add(pool.submit(run, task))
            while waiting:
                done, waiting = wait(waiting, return_when=FIRST_COMPLETED)
                yield from _reports(done)
        finally:
            # After Ctrl-C the other shards end with their current batch.
            stopped.set()
            pool.shutdown(wait=False, cancel_futures=True)


def _reports(done: Iterable[Future[list[Report]]]) -> Iterator[Report]:
    for future in done:
        yield from future.result()


def ray(
    tasks: Iterable[Task],
    bodies: Bodies,
    workers: int,
    address: str | None = None,
    answer: Answerer = answer_shard,
    resources: Resources = Resources(),
) -> Iterator[Report]:
    """Answers shards as tasks of a Ray cluster; without an address a local one is started.

    Yields the reports as tasks finish. Every node must find the files under the same names. The
    table of bodies is read here and copied once to the object store, which all workers of a node
    share. So are footers, once for all tasks of a file. Each worker builds and caches the bodies
    that it needs. Meshes are read by every worker. A task whose worker dies is repeated up to five
    times.
    """
    import ray

    if not ray.is_initialized():
        here: dict[str, Any] = {"num_cpus": workers, "include_dashboard": False}
        here["object_store_memory"] = 256 << 20
        # Without an address Ray would connect to a cluster that runs on this machine.
        ray.init(address=address or "local", log_to_driver=False, **({} if address else here))
    bodies.share()
    store = ray.put(bodies)

    def answer_with(jobs: list[Job], boxed: list[Any], sources: list[Any]) -> list[Report]:
        known = _kept(boxed[0])
        found = (source and _kept(source) for source in sources)
        return [
            _light(attempt(answer, replace(job, source=source), known))
            for job, source in zip(jobs, found, strict=True)
        ]

    remote: Any = ray.remote(max_retries=5, num_cpus=resources.cpus, memory=resources.memory)
    run = remote(answer_with)
    footers = _Footers(ray.put)
    waiting: dict[Any, Task] = {}

    def finished() -> Iterator[Report]:
        (future,), _ = ray.wait(list(waiting))
        jobs = waiting.pop(future)
        try:
            found = ray.get(future)
            yield from (replace(it, job=job) for it, job in zip(found, jobs, strict=True))
        except ray.exceptions.RayError as error:
            for job in jobs:
                yield Report(job, failure=f"{job.queries}: {error}", error=type(error).__name__)

    most, asked = 0, -math.inf
    for task in tasks:
        if time.monotonic() - asked >= FRESH:
            most, asked = _most(ray, resources), time.monotonic()
        while len(waiting) >= most:
            yield from finished()
        options = [replace(job.options, threads=resources.cpus) for job in task]
        jobs = [replace(j, options=o, source=None) for j, o in zip(task, options, strict=True)]
        waiting[run.remote(jobs, [store], [footers.of(job) for job in task])] = task
    while waiting:
        yield from finished()


def _most(ray: Any, resources: Resources) -> int:
    """Returns the maximum number of tasks that wait or run in the cluster as it is now."""
    if resources.in_flight is not None:
        return resources.in_flight
    return max(2, int(2 * ray.cluster_resources().get("CPU", 1) // resources.cpus))


def _light(report: Report) -> Report:
    """Returns a report without the footer, which its reader has."""
    return replace(report, job=replace(report.job, source=None))


class _Footers:
    """References to the sources of shards. The reference of a source is reused while shards of the
    same file follow each other."""

    def __init__(self, put: Callable[[Any], Any]) -> None:
        self.put, self.reference = put, None
        self.last: Source | None = None

    def of(self, job: Job) -> Any:
        if job.source is not self.last:
            self.last = job.source
            self.reference = None if job.source is None else self.put(job.source)
        return self.reference


def _kept(reference: Any) -> Any:
    """Returns the object of a reference, which a worker fetches once."""
    import ray

    name = reference.hex()
    if name not in _KEPT:
        _KEPT[name] = ray.get(reference)
        while len(_KEPT) > KEPT:
            _KEPT.popitem(last=False)
    _KEPT.move_to_end(name)
    return _KEPT[name]
