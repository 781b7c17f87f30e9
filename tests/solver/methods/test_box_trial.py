"""What the box method measures of a trial, against the same by numpy."""

import numpy as np
import pytest

from solver.methods.space.box.fields import KAPPA, State
from solver.methods.space.box.trial import measure_trial

H, N = 0.1, 5


def states():
    rng = np.random.default_rng(1)
    old, new = State.empty(N + 1), State.empty(N + 1)
    for state in (old, new):
        for array in (state.Y, state.rate, state.r, state.quaternion):
            array[:] = rng.normal(size=array.shape)
        state.quaternion[:] /= np.linalg.norm(state.quaternion, axis=1)[:, None]
    return old, new


def test_turn_acceleration_and_motion_are_the_largest_ones_and_bending_is_of_the_whole_rod():
    old, new = states()
    found = measure_trial(old, new, H, np.empty((N, 3)))
    assert found.turn == pytest.approx(H * np.linalg.norm(new.Y[:, KAPPA : KAPPA + 3], axis=1).max())
    assert found.acceleration == pytest.approx(np.abs(new.rate[:, :3] - old.rate[:, :3]).max())
    means = 0.5 * (new.Y[1:, KAPPA : KAPPA + 2] + new.Y[:-1, KAPPA : KAPPA + 2])
    assert found.bending == pytest.approx(H * np.linalg.norm(means, axis=1).sum())
    assert found.motion == pytest.approx(np.abs(new.r - old.r).max())


@pytest.mark.parametrize("spoilt", ["r", "rate", "kappa"])
@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_what_is_not_finite_anywhere_is_told_by_all(spoilt, value):
    old, new = states()
    array = new.Y[:, KAPPA:] if spoilt == "kappa" else getattr(new, spoilt)
    array[2, 1] = value
    assert np.isnan(measure_trial(old, new, H, np.empty((N, 3)))).all()
