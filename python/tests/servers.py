"""Servers for tests: of files by HTTP, with counts and faults, and of a bucket of S3."""

import hashlib
import re
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any
from urllib.parse import quote, unquote
from urllib.request import urlopen

import pytest


class FileServer(ThreadingHTTPServer):
    """Serves the files of a folder at 127.0.0.1.

    Attributes
    ----------
    ranges : bool
        Whether requests of ranges are served as such.
    faults : int
        Number of requests, from now on, that have the status 503.
    sent : int
        Number of bytes of all contents that were sent.
    requests : list of tuple
        Method, path and range of each request.
    """

    daemon_threads = True

    def __init__(self, folder: Path, ranges: bool = True) -> None:
        super().__init__(("127.0.0.1", 0), Handler)
        self.folder, self.ranges = folder, ranges
        self.faults = self.sent = 0
        self.requests: list[tuple[str, str, str | None]] = []
        self.lock = threading.Lock()

    @property
    def url(self) -> str:
        return f"http://127.0.0.1:{self.server_address[1]}"

    def handle_error(self, request: object, client_address: object) -> None:
        """Ignores clients that close their connection early."""

    def gets(self, name: str) -> list[str | None]:
        """Returns the ranges of all requests for the content of a file."""
        return [range for method, path, range in self.requests if (method, path) == ("GET", name)]


class Handler(BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"
    server: FileServer

    def do_HEAD(self) -> None:
        self.answer()

    def do_GET(self) -> None:
        self.answer()

    def answer(self) -> None:
        path, asked = unquote(self.path), self.headers.get("Range")
        with self.server.lock:
            self.server.requests.append((self.command, path.lstrip("/"), asked))
            failing = self.server.faults > 0
            self.server.faults -= failing
        file = self.server.folder / path.strip("/")
        if failing or not file.exists():
            self.send(503 if failing else 404, b"")
        elif file.is_dir():
            root = self.server.folder
            links = (f"<a href='/{quote(str(f.relative_to(root)))}'>f</a>" for f in file.iterdir())
            self.send(200, "".join(links).encode())
        else:
            content = file.read_bytes()
            found = re.fullmatch(r"bytes=(\d+)-(\d*)", asked or "") if self.server.ranges else None
            if not found:
                self.send(200, content)
                return
            begin, end = int(found[1]), min(int(found[2] or len(content)), len(content) - 1)
            if begin >= len(content):
                self.send(416, b"")
                return
            self.send(206, content, begin, end + 1)

    def send(self, status: int, whole: bytes, begin: int = 0, end: int | None = None) -> None:
        content = whole[begin:end]
        self.send_response(status)
        self.send_header("Content-Length", str(len(content)))
        if status < 400:
            self.send_header("ETag", hashlib.sha256(whole).hexdigest())
        if status == 206:
            self.send_header("Content-Range", f"bytes {begin}-{end}/{len(whole)}")
        self.end_headers()
        if self.command == "GET":
            self.wfile.write(content)
            with self.server.lock:
                self.server.sent += len(content)

    def log_message(self, format: str, *args: object) -> None:
        """Keeps the output of the tests free of requests."""


@contextmanager
def serving(folder: Path, ranges: bool = True) -> Iterator[FileServer]:
    with FileServer(folder, ranges) as server:
        thread = threading.Thread(target=server.serve_forever, daemon=True)
        thread.start()
        try:
            yield server
        finally:
            server.shutdown()
            thread.join()


@contextmanager
def s3_bucket(monkeypatch: pytest.MonkeyPatch) -> Iterator[Any]:
    """Starts a server of S3 with an empty bucket, ``s3://bucket``; provides its file system."""
    s3fs = pytest.importorskip("s3fs")
    server = pytest.importorskip("moto.server").ThreadedMotoServer(port=0)
    known = {"ACCESS_KEY_ID": "testing", "SECRET_ACCESS_KEY": "testing"}
    for name, value in (known | {"DEFAULT_REGION": "us-east-1"}).items():
        monkeypatch.setenv(f"AWS_{name}", value)
    server.start()
    try:
        _, port = server.get_host_and_port()
        monkeypatch.setenv("AWS_ENDPOINT_URL", f"http://127.0.0.1:{port}")
        urlopen(f"http://127.0.0.1:{port}/moto-api/reset", b"").close()
        s3fs.S3FileSystem.clear_instance_cache()
        system = s3fs.S3FileSystem()
        system.mkdir("bucket")
        yield system
    finally:
        server.stop()
        s3fs.S3FileSystem.clear_instance_cache()
