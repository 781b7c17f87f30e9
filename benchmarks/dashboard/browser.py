"""The API on loopback and a headless Chromium that draws WebGL by software."""

from __future__ import annotations

import socket
import threading
import time
from collections.abc import Callable, Iterator
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
def browsing() -> Iterator[Callable[[], Any]]:
    """Gives what opens an empty page, with cookies and storage of its own."""
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=ARGUMENTS)

        def opened() -> Any:
            page = browser.new_page(viewport={"width": 1200, "height": 800})
            page.set_default_timeout(60_000)
            return page

        yield opened
        browser.close()
