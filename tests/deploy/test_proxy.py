"""deploy/proxy/nginx.conf in front of the API, both on loopback: TLS, what is passed on, what is not."""

from __future__ import annotations

import shutil
import socket
import ssl
import subprocess
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import httpx
import pytest

from benchmarks.dashboard.browser import serving
from service.settings import Settings

NGINX = shutil.which("nginx", path="/usr/sbin:/usr/bin")
FILE = Path(__file__).parents[2] / "deploy" / "proxy" / "nginx.conf"
NAME = "hockle.example"
pytestmark = pytest.mark.skipif(NGINX is None, reason="no nginx on this machine")


def free_port() -> int:
    with socket.create_server(("127.0.0.1", 0)) as listening:
        return int(listening.getsockname()[1])


@pytest.fixture
def proxy(tmp_path: Path, tables: None) -> Iterator[tuple[int, int, ssl.SSLContext]]:
    """The ports of HTTP and HTTPS, and what trusts the certificate."""
    key = ["openssl", "req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:P-256", "-nodes", "-days", "2",
           "-subj", f"/CN={NAME}", "-addext", f"subjectAltName=DNS:{NAME}", "-keyout", str(tmp_path / "privkey.pem"),
           "-out", str(tmp_path / "fullchain.pem")]  # fmt: skip
    subprocess.run(key, check=True, capture_output=True)
    plain, secure = free_port(), free_port()
    settings = replace(Settings(data=tmp_path / "data"), require_keys=True, hosts=NAME)
    with serving(settings, keyed=True) as server:
        told = FILE.read_text().replace("/etc/ssl/hockle", str(tmp_path))
        moved = {"127.0.0.1:8000": server.address.removeprefix("http://"), "listen 80;": f"listen {plain};",
                 "listen 443 ": f"listen {secure} "}  # fmt: skip
        for there, here in moved.items():
            assert told.count(there) == 1
            told = told.replace(there, here)
        inside = f"access_log off;\nclient_body_temp_path {tmp_path}/body;\nproxy_temp_path {tmp_path}/proxy;\n{told}"
        (tmp_path / "nginx.conf").write_text(
            f"daemon off;\npid {tmp_path}/nginx.pid;\nerror_log stderr;\nevents {{}}\nhttp {{\n{inside}\n}}\n")
        command = [str(NGINX), "-e", "stderr", "-p", str(tmp_path), "-c", str(tmp_path / "nginx.conf")]
        subprocess.run([*command, "-t"], check=True, capture_output=True)
        process = subprocess.Popen(command)
        try:
            yield plain, secure, ssl.create_default_context(cafile=str(tmp_path / "fullchain.pem"))
        finally:
            process.terminate()
            process.wait(30)


def ask(port: int, path: str, trust: ssl.SSLContext | bool = False, scheme: str = "https") -> httpx.Response:
    """An answer of the proxy, asked for by its name."""
    with httpx.Client(verify=trust, trust_env=False) as client:
        for _ in range(50):
            try:
                return client.get(f"{scheme}://127.0.0.1:{port}{path}", headers={"Host": NAME},
                                  extensions={"sni_hostname": NAME})  # fmt: skip
            except httpx.ConnectError:
                time.sleep(0.1)
    raise AssertionError("nginx does not listen")


def test_it_speaks_tls_asks_for_a_key_and_keeps_metrics_inside(proxy):
    plain, secure, trust = proxy
    moved = ask(plain, "/v1/jobs", scheme="http")
    assert (moved.status_code, moved.headers["location"]) == (301, f"https://{NAME}/v1/jobs")
    page = ask(secure, "/", trust)
    assert page.status_code == 200 and "hockle" in page.text
    assert page.headers["strict-transport-security"] == "max-age=31536000"
    assert ask(secure, "/v1/jobs", trust).status_code == 401
    assert ask(secure, "/metrics", trust).status_code == 404
