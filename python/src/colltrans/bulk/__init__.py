"""Queries in files: one shard in, one shard out, on one machine or a cluster.

``python -m colltrans.bulk QUERIES OUT`` is the program; :func:`answer_table` is what it does to a
table, for pipelines of one's own (``ray.data.Dataset.map_batches``).

The way: ``files`` (paths and URLs) -> ``bodies`` (keys to bodies) -> ``reads`` (which columns a
question reads) -> ``lines`` (JSON to tables) -> ``table`` (a table of queries to one of answers) ->
``shard`` (a file to a file) -> ``engines`` (which process answers which shard) -> ``__main__``. A
shard knows nothing of engines.
"""

from colltrans.bulk.bodies import Bodies
from colltrans.bulk.shard import Job, Report, answer_shard, check_shard
from colltrans.bulk.table import Options, answer_table

__all__ = ["Bodies", "Job", "Options", "Report", "answer_shard", "answer_table", "check_shard"]
