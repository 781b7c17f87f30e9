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

PLAYWRIGHTS = ("AvoidUnnecessaryBeforeUnloadCheckSync", "DestroyProfileOnBrowserClose", "HttpsUpgrades",
               "HttpsFirstBalancedModeAutoEnable", "LensOverlay", "MediaRouter", "PaintHolding",
               "ThirdPartyStoragePartitioning", "AvoidCorsURLLoaderRestartOnRedirect", "TcpPortRandomizationWin",
               "OptimizationHints", "NetworkTimeServiceQuerying", "AimEnabled", "PreconnectToSearch")  # fmt: skip
"""What Playwright turns off: of several lists of features Chromium takes the last."""
WINDOWS = ("WebUIOmniboxPopup", "WebUIOmniboxFullPopup", "WebUIOmniboxAimPopup")
"""The suggestions below a window's address, a page of its own in each window."""
SPARING = [f"--disable-features={','.join(PLAYWRIGHTS + WINDOWS)}", "--disable-gpu-compositing"]
"""More arguments, for who looks at what pages hold and not at how fast they are drawn. Nobody sees the windows, and
what WebGL does not draw is drawn without the graphics card that is only imitated: a page takes half of the CPU time."""


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
def browsing(*more: str) -> Iterator[Callable[[], Any]]:
    """Gives what opens an empty page, with cookies and storage of its own; `more` are arguments of the browser."""
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=[*ARGUMENTS, *more])

        def opened() -> Any:
            page = browser.new_page(viewport={"width": 1200, "height": 800})
            page.set_default_timeout(60_000)
            return page

        yield opened
        browser.close()
