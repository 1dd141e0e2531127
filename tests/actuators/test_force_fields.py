import numpy as np
import pytest

from limitsurf.actuators.force_fields import (
    elliptic_field,
    radial_field,
    skewed_squeeze_field,
    squeeze_field,
    uniform_field,
)


def curl_and_divergence(field, points, h=1e-5):
    """Return curl and divergence by central differences."""
    right, up = np.array([h, 0.0]), np.array([0.0, h])
    dx = (field(points + right) - field(points - right)) / (2 * h)
    dy = (field(points + up) - field(points - up)) / (2 * h)
    return dx[..., 1] - dy[..., 0], dx[..., 0] + dy[..., 1]


def test_no_field_pushes_harder_than_an_actuator(rng):
    points = rng.normal(size=(500, 2))
    for field in (
        uniform_field(0.3),
        squeeze_field(0.3, 0.1),
        skewed_squeeze_field(0.3, -0.5),
        radial_field(),
        elliptic_field((1.0, 3.0), 0.7, 0.4),
    ):
        assert np.linalg.norm(field(points), axis=-1).max() <= 1.0 + 1e-12


def test_elliptic_field_is_minus_a_gradient_and_turns_with_its_axis(rng):
    points = 0.2 * rng.normal(size=(50, 2))
    field = elliptic_field((1.0, 3.0), 10.0, 0.4)
    curl, divergence = curl_and_divergence(field, points)
    assert curl == pytest.approx(0.0, abs=1e-9)
    assert divergence == pytest.approx(-4.0 / 30.0)
    axis = np.array([np.cos(0.4), np.sin(0.4)])
    assert field(axis[None])[0] == pytest.approx(-axis / 30.0)


def test_elliptic_field_reaches_full_push_along_the_stiffer_axis():
    field = elliptic_field((3.0, 1.0), 2.0)
    assert field(np.array([[2.0, 0.0], [9.0, 0.0], [1.0, 0.0]])) == pytest.approx(
        np.array([[-1.0, 0.0], [-1.0, 0.0], [-0.5, 0.0]])
    )


def test_radial_field_points_to_the_centre():
    field = radial_field((1.0, 2.0))
    assert field(np.array([[1.0, 2.0], [4.0, 6.0]])) == pytest.approx(
        np.array([[0.0, 0.0], [-0.6, -0.8]])
    )


def test_skew_turns_both_sides_the_same_way():
    points = np.array([[0.0, 1.0], [0.0, -1.0]])
    up, down = skewed_squeeze_field(0.0, 0.3)(points)
    assert up == pytest.approx([-np.sin(0.3), -np.cos(0.3)])
    assert down == pytest.approx(-up)
    assert squeeze_field(0.0)(points)[0] == pytest.approx([0.0, -1.0])


def test_squeeze_line_can_be_offset():
    field = squeeze_field(0.0, 2.0)
    assert field(np.array([[0.0, 1.0]]))[0] == pytest.approx([0.0, 1.0])
