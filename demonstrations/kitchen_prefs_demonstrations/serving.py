"""Serves the page on this machine and saves each demonstration that it sends.

    GET  /                     the page
    POST /demonstrations       a demonstration's JSON, which becomes FOLDER/demonstration-0001.json
    POST /demonstrations/FILE  the same demonstration with another name or consent

It listens on the loopback interface alone. A page of another origin can send requests there, too,
also by a host name of its own that points here; so Host and Origin must be this server's.
"""

import errno
import json
import re
import sys
import threading
from collections.abc import Callable
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any

from kitchen_prefs_demonstrations.file_format import (
    MOST_BYTES,
    DemonstrationFile,
    parse_demonstration,
    read_demonstration,
    write_demonstration,
)
from kitchen_prefs_demonstrations.replaying import ReplayedDemonstration, replay

LOOPBACK = "127.0.0.1"
SAVE_TO = "demonstrations"  # the address that the page posts to, relative to its own
POSTED = re.compile(rf"/{SAVE_TO}(?:/(demonstration-[0-9]{{4,9}}\.json))?")
MAY_CHANGE = {"user", "consent"}  # of a demonstration that is saved
PATIENCE = 10  # seconds to wait for a request that has begun

Progress = Callable[[Path, ReplayedDemonstration], None]


class DemonstrationServer(ThreadingHTTPServer):
    """Serves a page and saves what it sends; `serve_forever` runs it.

    Args:
        page: The page's HTML.
        folder: Where demonstrations are saved; it exists.
        port: The port; 0 takes any that is free.
        on_saved: Called with each saved file and its demonstration.
        study: The only study whose demonstrations it saves; None saves all.

    Raises:
        OSError: If the port is taken.
    """

    daemon_threads = False  # closing waits for what is being written

    def __init__(
        self, page: str, folder: Path, port: int, on_saved: Progress, study: str | None = None
    ) -> None:
        self.page = page.encode()
        self._folder = folder
        self._on_saved = on_saved
        self._study = study
        self._saving = threading.Lock()
        try:
            super().__init__((LOOPBACK, port), _Handler)
        except OSError as error:
            if error.errno in (errno.EADDRINUSE, errno.EACCES):
                raise OSError(f"The port {port} is taken; give another --port.") from error
            raise

    @property
    def hosts(self) -> tuple[str, str]:
        """The names under which a browser on this machine reaches it."""
        return f"{LOOPBACK}:{self.server_port}", f"localhost:{self.server_port}"

    @property
    def address(self) -> str:
        """The page's address."""
        return f"http://{self.hosts[0]}/"

    def save(self, content: bytes, name: str | None) -> Path:
        """Save a demonstration.

        Args:
            content: Its JSON.
            name: The file whose name or consent it changes; None saves it under the next free
                number.

        Raises:
            ValueError: If it is none, or another one than the file's.
            OSError: If it cannot be written.
        """
        demonstration = parse_demonstration(content, "The demonstration")
        self._check_study(demonstration)
        replayed = replay(demonstration, "The demonstration")
        with self._saving:
            file = self._folder / name if name else _next_file(self._folder)
            if name:
                _check_same(demonstration, read_demonstration(file), name)
            write_demonstration(demonstration, file)
            self._on_saved(file, replayed)
        return file

    def _check_study(self, demonstration: DemonstrationFile) -> None:
        theirs = demonstration.study.name if demonstration.study else "no study"
        if self._study not in (None, theirs):
            raise ValueError(f"This page serves the study {self._study}, and not {theirs}.")

    def handle_error(self, request: Any, client_address: Any) -> None:
        """Report an error of a request; a browser that has left is none."""
        if not isinstance(sys.exception(), ConnectionError):
            super().handle_error(request, client_address)


def _next_file(folder: Path) -> Path:
    numbers = [file.stem.rpartition("-")[2] for file in folder.glob("demonstration-*.json")]
    last = max((int(number) for number in numbers if number.isdecimal()), default=0)
    return folder / f"demonstration-{last + 1:04}.json"


def _check_same(one: DemonstrationFile, other: DemonstrationFile, name: str) -> None:
    if one.model_dump(exclude=MAY_CHANGE) != other.model_dump(exclude=MAY_CHANGE):
        raise ValueError(f"{name} holds another demonstration.")


class _Refused(Exception):  # noqa: N818  it is an answer, not an error of the server
    def __init__(self, status: HTTPStatus, sentence: str) -> None:
        super().__init__(sentence)
        self.status = status


class _Handler(BaseHTTPRequestHandler):
    server: DemonstrationServer
    timeout = PATIENCE

    def do_GET(self) -> None:
        self._answer(self._page)

    def do_POST(self) -> None:
        self._answer(self._save)

    def log_message(self, format: str, *args: object) -> None:
        """Say nothing of requests; each saved demonstration has a line."""

    def _answer(self, action: Callable[[], tuple[HTTPStatus, str, bytes]]) -> None:
        try:
            self._check_host()
            status, kind, body = action()
        except _Refused as refused:
            status, kind, body = refused.status, "application/json", _json(error=str(refused))
        self.send_response(status)
        self.send_header("Content-Type", f"{kind}; charset=utf-8")
        self.send_header("Content-Length", str(len(body)))
        self.send_header("Cache-Control", "no-store")
        self.send_header("X-Content-Type-Options", "nosniff")
        self.send_header("X-Frame-Options", "DENY")
        self.send_header("Referrer-Policy", "no-referrer")
        self.end_headers()
        self.wfile.write(body)

    def _page(self) -> tuple[HTTPStatus, str, bytes]:
        if self.path != "/":
            raise _Refused(HTTPStatus.NOT_FOUND, "There is only the page, at /.")
        return HTTPStatus.OK, "text/html", self.server.page

    def _save(self) -> tuple[HTTPStatus, str, bytes]:
        posted = POSTED.fullmatch(self.path)
        if not posted:
            raise _Refused(HTTPStatus.NOT_FOUND, f"Demonstrations go to /{SAVE_TO}.")
        if self.headers.get("Origin") != f"http://{self.headers.get('Host')}":
            raise _Refused(HTTPStatus.FORBIDDEN, "Only the page itself may send demonstrations.")
        if self.headers.get_content_type() != "application/json":
            raise _Refused(HTTPStatus.UNSUPPORTED_MEDIA_TYPE, "A demonstration is JSON.")
        try:
            file = self._saved_file(posted[1])
            return HTTPStatus.CREATED, "application/json", _json(file=file.name)
        except ValueError as error:
            raise _Refused(HTTPStatus.BAD_REQUEST, str(error)) from error
        except OSError as error:
            sentence = f"The demonstration could not be saved: {error.strerror}."
            raise _Refused(HTTPStatus.INTERNAL_SERVER_ERROR, sentence) from error

    def _saved_file(self, name: str | None) -> Path:
        length = self.headers.get("Content-Length", "")
        if not length.isascii() or not length.isdecimal():
            raise _Refused(HTTPStatus.LENGTH_REQUIRED, "A demonstration comes with its length.")
        if len(length) > len(str(MOST_BYTES)) or int(length) > MOST_BYTES:
            sentence = f"A demonstration has at most {MOST_BYTES:,} bytes."
            raise _Refused(HTTPStatus.REQUEST_ENTITY_TOO_LARGE, sentence)
        try:
            content = self.rfile.read(int(length))
        except TimeoutError as error:
            raise _Refused(HTTPStatus.REQUEST_TIMEOUT, "The demonstration did not come.") from error
        if len(content) < int(length):
            raise _Refused(HTTPStatus.BAD_REQUEST, "The demonstration is shorter than it says.")
        return self.server.save(content, name)

    def _check_host(self) -> None:
        if self.headers.get("Host") not in self.server.hosts:
            raise _Refused(HTTPStatus.FORBIDDEN, f"The page is at {self.server.address} alone.")


def _json(**content: str) -> bytes:
    return json.dumps(content).encode()
