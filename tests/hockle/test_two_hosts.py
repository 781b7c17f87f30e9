"""Two hosts, one database, broker and store: either answers for all jobs, and what one loses the other takes over."""

from __future__ import annotations

import socket
import sys
import threading
from contextlib import suppress
from pathlib import Path

import pytest

from chaos.campaign import free_port
from chaos.cases import digest, undisturbed
from hockle_client import Client
from service.cases import apply_settings

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="looks at processes through /proc")


class Link:
    """A port of this machine that leads to a server's, until it is cut; then it leads nowhere until it is mended."""

    def __init__(self, family: socket.AddressFamily, address: str | tuple[str, int]) -> None:
        self._family, self._address, self._ends = family, address, set[socket.socket]()
        self._lock, self.cut, self.port = threading.Lock(), False, free_port()
        self._listener = socket.create_server(("127.0.0.1", self.port))
        threading.Thread(target=self._accept, daemon=True).start()

    def break_off(self) -> None:
        """End all connections, and every new one at once."""
        self.cut = True
        with self._lock:
            for end in self._ends:
                with suppress(OSError):
                    end.shutdown(socket.SHUT_RDWR)

    def close(self) -> None:
        """Lead nowhere for good."""
        self.break_off()
        self._listener.close()

    def _accept(self) -> None:
        with suppress(OSError):
            while True:
                near, _ = self._listener.accept()
                far = socket.socket(self._family)
                with self._lock:
                    self._ends |= {near, far}
                threading.Thread(target=self._connect, args=(near, far), daemon=True).start()

    def _connect(self, near: socket.socket, far: socket.socket) -> None:
        with near, far, suppress(OSError):
            if not self.cut:
                far.connect(self._address)
                back = threading.Thread(target=_pass_on, args=(far, near), daemon=True)
                back.start()
                _pass_on(near, far)
                back.join()
        with self._lock:
            self._ends -= {near, far}


def _pass_on(source: socket.socket, target: socket.socket) -> None:
    with suppress(OSError):
        while data := source.recv(65536):
            target.sendall(data)
    with suppress(OSError):
        target.shutdown(socket.SHUT_RDWR)


def test_a_host_that_is_cut_off_loses_its_job_to_the_other_and_is_back_later(
    start, postgresql, broker, slow, quick, until, tmp_path
):
    slow = apply_settings(slow, {"t_end": 7.0})  # more than a lease
    links = [Link(socket.AF_UNIX, str(postgresql.directory / ".s.PGSQL.5432")),
             Link(socket.AF_INET, ("127.0.0.1", broker))]  # fmt: skip
    shared = {"HOCKLE_STORE": str(tmp_path / "store")}
    cut_off = shared | {"HOCKLE_DATABASE": f"postgresql://hockle@127.0.0.1:{links[0].port}/postgres",
                        "REDIS_URL": f"redis://127.0.0.1:{links[1].port}/0"}  # fmt: skip
    stays = shared | {"HOCKLE_DATABASE": postgresql.url(), "REDIS_URL": f"redis://127.0.0.1:{broker}/0"}
    with start(tmp_path / "a", **cut_off) as a, Client(a.address) as at_a:
        long = at_a.submit(slow).id
        until(lambda: at_a.job(long).progress > 0.02, "the job runs on the one host")
        for link in links:
            link.break_off()
        with start(tmp_path / "b", **stays) as b, Client(b.address) as at_b:
            short = at_b.submit(quick).id
            ends = {job_id: at_b.job(job_id).wait() for job_id in (short, long)}
            assert {job_id: (end.status, end.state.attempts) for job_id, end in ends.items()} == \
                {short: ("successful", 1), long: ("successful", 2)}  # fmt: skip
            until(lambda: not a.ready, "the host that is cut off says so")
            for link in links:
                link.cut = False
            until(lambda: a.ready, "it is back")
            for client, name in ((at_a, "a.nc"), (at_b, "b.nc")):
                client.job(long).fetch(tmp_path / name)
            assert (tmp_path / "a.nc").read_bytes() == (tmp_path / "b.nc").read_bytes()
            again = at_a.submit(quick | {"description": "once more"}).id
            assert at_b.job(again).wait().status == "successful"
    for link in links:
        link.close()
    assert digest(tmp_path / "b.nc") == undisturbed(slow)
    assert len(list(Path(tmp_path / "store" / "datasets").iterdir())) == 3
