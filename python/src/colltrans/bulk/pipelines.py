"""A class that answers batches of queries in pipelines of Ray Data, Daft and Spark."""

import uuid
from collections import OrderedDict
from collections.abc import Iterable, Iterator
from dataclasses import replace
from typing import Any

import pyarrow as pa

from colltrans.bulk.bodies import Bodies
from colltrans.bulk.table import Options, answer_table, failed_table
from colltrans.errors import InputError, as_error

#: Maximum number of unpickled objects that a process keeps, with their bodies.
KEPT = 4
#: The unpickled objects of this process, by their name.
_KEPT: "OrderedDict[str, Answer]" = OrderedDict()


class Answer:
    """Answers batches of queries as Arrow tables: an actor for ``ray.data.Dataset.map_batches``.

    A batch never raises an exception: each of its rows has an answer, or the outcome *error* with
    the columns ``error`` and ``message``. If the columns of a batch are wrong, all its rows have
    the same error. All columns have types that Ray Data, Daft and Spark can read: texts, numbers
    and lists.

    Copies in other processes read the table of bodies once in each process, and keep their bodies.

    Parameters
    ----------
    bodies : Bodies or str, optional
        Bodies, or the path or URL of their table. By default keys are paths of mesh files.
    options : Options, optional
        The question. Each batch uses one thread unless ``threads`` is set.

    Examples
    --------
    >>> import pyarrow as pa
    >>> from colltrans.bulk import Answer, Options
    >>> answer = Answer(options=Options("distance"))
    >>> told = answer(pa.table({"moving": ["none.stl"], "fixed": ["none.stl"]}))
    >>> told["outcome"].to_pylist(), told["error"].to_pylist()
    (['error'], ['MissingFileError'])
    """

    def __init__(self, bodies: Bodies | str | None = None, options: Options | None = None) -> None:
        self.bodies = bodies if isinstance(bodies, Bodies) else Bodies(bodies)
        options = options or Options()
        self.options = options if options.threads else replace(options, threads=1)
        self.options.reads(self.bodies.solids)
        self._name = uuid.uuid4().hex

    def __call__(self, batch: Any) -> Any:
        """Answers a table or a record batch.

        Raises
        ------
        InputError
            The batch is neither; for Ray Data pass ``batch_format="pyarrow"``.
        """
        if not isinstance(batch, (pa.Table, pa.RecordBatch)):
            wanted = 'give a pyarrow.Table, in Ray Data by batch_format="pyarrow"'
            raise InputError(f"batch: {type(batch).__name__} is not a table; {wanted}")
        queries = pa.Table.from_batches([batch]) if isinstance(batch, pa.RecordBatch) else batch
        try:
            answers = answer_table(queries, self.bodies, self.options)
        except BaseException as error:
            told = as_error(error, "this batch")
            answers = failed_table(queries, told, self.bodies, self.options)
        return answers.cast(_plain(answers.schema))

    def batches(self, batches: Iterable[Any]) -> Iterator[Any]:
        """Yields the answers of record batches, as ``DataFrame.mapInArrow`` of Spark expects."""
        for batch in batches:
            yield from self(batch).combine_chunks().to_batches()

    def schema(self, queries: Any) -> Any:
        """Returns the schema of the answers of queries with this schema.

        Raises
        ------
        ColltransError
            The columns are wrong.
        """
        return _plain(answer_table(queries.empty_table(), self.bodies, self.options).schema)

    def __reduce__(self) -> Any:
        return _restored, (self._name, self.bodies, self.options)


def _restored(name: str, bodies: Bodies, options: Options) -> Answer:
    """Returns a copy, the same one whenever an object is unpickled again in this process."""
    if name not in _KEPT:
        _KEPT[name] = Answer(bodies, options)
        _KEPT[name]._name = name
        while len(_KEPT) > KEPT:
            _KEPT.popitem(last=False)
    _KEPT.move_to_end(name)
    return _KEPT[name]


def _plain(schema: Any) -> Any:
    """Replaces dictionaries by their values and lists of fixed size by lists."""
    return pa.schema([pa.field(field.name, _plain_type(field.type)) for field in schema])


def _plain_type(kind: Any) -> Any:
    if pa.types.is_dictionary(kind):
        return _plain_type(kind.value_type)
    if pa.types.is_fixed_size_list(kind):
        return pa.list_(kind.value_type)
    return kind
