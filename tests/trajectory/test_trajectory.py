import numpy as np
import pytest

from nao_kin.chain import ChainJoint
from nao_kin.errors import InvalidInputError, UnknownNameError
from nao_kin.trajectory import Trajectory


@pytest.fixture
def swing() -> Trajectory:
    return Trajectory([ChainJoint("a", upper=1.0), "b"], [0.0, 0.5, 2.0], [[0, 0], [1, -1], [1, 2]], "swing")


def test_what_it_holds(swing):
    assert swing.joint_names == ("a", "b")
    assert len(swing) == 3
    assert swing.duration == 2.0
    assert swing.posture(-1) == {"a": 1.0, "b": 2.0}
    np.testing.assert_array_equal(swing.column("b"), [0, -1, 2])
    np.testing.assert_allclose(swing.velocities, [[2, -2], [0, 2]])


def test_straight_in_between_and_held_at_the_ends(swing):
    np.testing.assert_allclose(swing.at(0.25), [0.5, -0.5])
    np.testing.assert_allclose(swing.at(-1.0), [0, 0])
    np.testing.assert_allclose(swing.at(9.0), [1, 2])


def test_nothing_can_be_changed_afterwards():
    q = np.zeros((2, 1))
    made = Trajectory(["a"], [0.0, 1.0], q)
    q[0] = 5.0
    assert made.q[0, 0] == 0.0
    with pytest.raises(ValueError, match="read-only"):
        made.q[0, 0] = 1.0


@pytest.mark.parametrize(
    ("joints", "times", "q", "said"),
    [
        (["a", "a"], [0.0], [[0, 0]], "'a' twice"),
        (["a"], [0.0, 0.0], [[0], [0]], "at sample 1"),
        (["a"], [0.0, 2.0, 1.0], [[0], [0], [0]], "1 s after 2 s at sample 2"),
        (["a"], [0.0], [[0], [0]], "times"),
        (["a"], [], np.zeros((0, 1)), "none"),
        (["a"], [0.0], [[np.nan]], "finite"),
        (["a", "b"], [0.0], [[0.0]], "q"),
    ],
)
def test_what_is_no_trajectory(joints, times, q, said):
    with pytest.raises(InvalidInputError, match=said):
        Trajectory(joints, times, q)


def test_names_and_samples_that_do_not_exist(swing):
    with pytest.raises(UnknownNameError):
        swing.column("c")
    with pytest.raises(InvalidInputError):
        swing.posture(3)
