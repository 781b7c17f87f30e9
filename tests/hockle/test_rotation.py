"""A log that is too large becomes an older one; what its process writes then comes into the new one."""

from __future__ import annotations

from hockle.rotation import KEPT, rotate


def test_a_log_within_its_bound_is_left_alone(tmp_path):
    log = tmp_path / "api.log"
    rotate(log, 10)
    log.write_text("0123456789")
    rotate(log, 10)
    assert [path.name for path in tmp_path.iterdir()] == ["api.log"]


def test_a_full_log_goes_on_empty_for_the_process_that_has_it_open(tmp_path):
    log = tmp_path / "api.log"
    with log.open("a") as writing:
        for number in range(9):
            writing.write(f"{number}" * 20)
            writing.flush()
            rotate(log, 10)
        writing.write("new")
    assert log.read_text() == "new"
    assert {path.name: path.read_text() for path in tmp_path.iterdir() if path != log} == {
        f"api.log.{number}": f"{9 - number}" * 20 for number in range(1, KEPT + 1)}


def test_where_there_is_no_room_nothing_is_lost(tmp_path, monkeypatch):
    log = tmp_path / "api.log"
    log.write_text("x" * 20)

    def full(_source, target):
        target.write_text("x")
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("shutil.copyfile", full)
    rotate(log, 10)
    assert log.read_text() == "x" * 20 and [path.name for path in tmp_path.iterdir()] == ["api.log"]
