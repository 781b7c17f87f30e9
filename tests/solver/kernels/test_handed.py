"""Records by reference: a kernel sees the arrays that Python has, and a record that was replaced is seen anew."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from solver import Contact
from solver.arrays import Array
from solver.kernels.handed import Reference
from solver.kernels.kernel import kernel
from solver.physics.contact.self_contact import SelfContact
from tests.solver.scenes import LENGTH, ROD


class Record(NamedTuple):
    values: Array
    factor: float


class Given(NamedTuple):
    record: Record
    others: Array


@kernel
def scaled(given, i):
    given.others[i] += 1.0
    return given.record.factor * given.record.values[i]


def test_a_kernel_reads_and_writes_the_arrays_that_python_has():
    record, others = Record(np.arange(3.0), 2.0), np.zeros(3)
    handed = Reference.to(Given(record, others))
    assert scaled(handed, 2) == 4.0
    record.values[2] = 7.0
    assert scaled(handed, 2) == 14.0
    assert others.tolist() == [0.0, 0.0, 2.0]


def test_records_of_one_class_are_told_apart_by_what_they_hold():
    whole = np.arange(6.0)
    for values in (whole, whole[::2], np.arange(3), whole[:3]):
        handed = Reference.to(Given(Record(values, 2.0), np.zeros(6)))
        assert scaled(handed, 2) == 2.0 * values[2]


def test_arrays_outlive_those_who_made_them():
    def made() -> Reference:
        return Reference.to(Given(Record(np.full(1000, 3.0), 1.0), np.zeros(1000)))

    several = [made() for _ in range(20)]
    assert [scaled(one, 999) for one in several] == [3.0] * 20


def test_a_record_that_was_replaced_is_handed_over_anew():
    record, others = Record(np.arange(3.0), 2.0), np.zeros(3)
    handed = Reference.to(Given(record, others))
    assert handed.again(Given(record, others)) is handed
    anew = handed.again(Given(record._replace(factor=5.0), others))
    assert anew is not handed
    assert scaled(anew, 1) == 5.0


def test_a_contact_search_that_needs_more_room_replaces_its_record():
    contact = Contact(k1=1e-7, k2=3.0, k3=1e-6, k4=1.0, aperture=1.0, cutoff=0.1, skip=0.3, spacing=0.01)
    search = SelfContact(contact, ROD, np.linspace(0.0, LENGTH, 41), stages=1)
    handed = Reference.to(search.touch)
    search._make_room(search.touch.points, 5000)
    assert handed.again(search.touch) is not handed


class Mixed(NamedTuple):
    present: bool
    count: int
    grid: Array
    inner: Record
    nothing: None
    pair: complex
    marks: NDArray[np.bool_]


@kernel
def told(mixed):
    total = mixed.inner.factor * mixed.inner.values[1] + mixed.grid[1, 2] + mixed.count + mixed.pair.imag
    return total if mixed.present and mixed.nothing is None and mixed.marks[1] else -1.0


def test_every_kind_of_field_arrives():
    marks = np.array([False, True])
    mixed = Mixed(True, 1000, np.arange(6.0).reshape(2, 3), Record(np.arange(2.0), 0.5), None, 1 + 0.25j, marks)
    assert told(Reference.to(mixed)) == 1005.75
    assert told(Reference.to(mixed._replace(present=False))) == -1.0
