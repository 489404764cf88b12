"""Queries in files: one shard of answers for each shard of queries, on one machine or a cluster.

``python -m colltrans.bulk QUERIES OUT`` is the program. :class:`Answer` answers batches of other
pipelines (Ray Data, Daft, Spark), :func:`answer_table` one table.

Each module uses only those before it: ``files`` (paths and URLs), ``sources`` (footers and row
groups), ``bodies`` (keys to bodies), ``reads`` (columns of a question), ``lines`` (JSON to tables),
``table`` (queries to answers), ``pipelines`` (batches to answers), ``shard`` (file to file),
``engines`` (distribution of shards to processes), ``__main__``.
"""

from colltrans.bulk.bodies import Bodies
from colltrans.bulk.files import ChangedError, NoRangesError, ReadError
from colltrans.bulk.pipelines import Answer
from colltrans.bulk.shard import Job, Report, answer_shard, check_shard
from colltrans.bulk.table import Options, answer_table

__all__ = [
    "Answer",
    "Bodies",
    "ChangedError",
    "Job",
    "NoRangesError",
    "Options",
    "ReadError",
    "Report",
    "answer_shard",
    "answer_table",
    "check_shard",
]
