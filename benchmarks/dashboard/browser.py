"""The API on loopback and a headless Chromium that draws WebGL by software."""

from __future__ import annotations

import socket
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from shutil import which
from types import SimpleNamespace
from typing import Any

import uvicorn

from service.api.app import create_app
from service.settings import Settings

CHROMIUM = which("chromium") or which("chromium-browser") or which("google-chrome")
ARGUMENTS = ["--headless", "--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--disable-quic",
             "--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync"]


@contextmanager
def serving(settings: Settings, keyed: bool = False) -> Iterator[SimpleNamespace]:
    """The API in a thread; gives its address and its application."""
    app = create_app(settings, keyed=keyed)
    listening = socket.create_server(("127.0.0.1", 0))
    server = uvicorn.Server(uvicorn.Config(app, log_level="warning", timeout_graceful_shutdown=1))
    thread = threading.Thread(target=server.run, kwargs={"sockets": [listening]})
    thread.start()
    while not server.started:
        assert thread.is_alive()
        time.sleep(0.01)
    try:
        yield SimpleNamespace(address=f"http://127.0.0.1:{listening.getsockname()[1]}", app=app)
    finally:
        server.should_exit = True
        thread.join()
        listening.close()


@contextmanager
def browsing(profile: str, **options: Any) -> Iterator[Any]:
    """A browser with a profile of its own, with an empty page."""
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        context = playwright.chromium.launch_persistent_context(
            profile, executable_path=CHROMIUM, args=ARGUMENTS, viewport={"width": 1200, "height": 800}, **options)
        context.set_default_timeout(60_000)
        yield context
        context.close()
