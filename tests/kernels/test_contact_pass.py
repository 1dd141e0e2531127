"""Sums over contacts: against long doubles, with kinks left out, by threads, and for ellipses."""

import numpy as np
import pytest

from limitsurf.kernels.contact_pass import (
    BLOCK,
    Contacts,
    Tree,
    contact_columns,
    contact_velocity,
    kink_of,
)
from limitsurf.kernels.contact_problem import second_moments
from limitsurf.kernels.contact_totals import (
    exact_sums,
    gradient,
    hessian,
    new_table,
    smoothed_sums,
    sum_error,
)
from limitsurf.kernels.moment_tree_build import build_moment_tree
from tests.kernels.clouds import clouds, twists, weights
from tests.kernels.test_symmetric3 import full, three


def contacts_of(x, y, m, stretch=None, threads=1):
    rows = [x, y, m] if stretch is None else [x, y, m, *stretch]
    return Contacts(np.array(rows), threads, None)


def truth(contacts, v, eps, out=()):
    """Return h, g, H, k in extended precision, without the contacts `out`."""
    data = contacts.data.astype(np.longdouble)
    x, y, m = data[:3]
    a, b, d = data[3:] if len(data) > 3 else (1 + 0 * x, 0 * x, 1 + 0 * x)
    P = np.array([[a, b, x * b - y * a], [b, d, x * d - y * b]]).transpose(2, 1, 0)  # N, 3, 2
    u = np.einsum("nij,i->nj", P, np.asarray(v).astype(np.longdouble))
    s = np.sqrt((u**2).sum(axis=1) + np.longdouble(eps) ** 2)
    keep = (s > 0) & ~np.isin(np.arange(len(x)), out)
    P, u, s, m = P[keep], u[keep], s[keep], m[keep]
    e = u / s[:, None]
    middle = (m / s)[:, None, None] * (np.eye(2) - e[:, :, None] * e[:, None, :])
    g = np.einsum("nij,nj->ni", P, m[:, None] * e)
    H = np.einsum("nij,njk,nlk->nil", P, middle, P)
    return (m * s).sum(), g, H, (m / s).sum()


def agree(contacts, table, v, eps, out=(), tol=None):
    h, g, H, k = truth(contacts, v, eps, out)
    tol = 4 * sum_error(contacts.data.shape[1]) if tol is None else tol
    total = table[-1]
    assert total[0] == pytest.approx(float(h), rel=tol, abs=1e-300)
    assert total[10] == pytest.approx(float(k), rel=1e3 * tol, abs=1e-300)
    assert np.all(np.abs(gradient(table) - g.sum(axis=0)) <= tol * np.abs(g).sum(axis=0) + 1e-300)
    return H.sum(axis=0).astype(float)


STRETCH = {"disks": None, "ellipses": (0.7, 0.2, 1.3), "turned disks": (1.0, 0.0, 1.0)}


@pytest.mark.parametrize("stretch", STRETCH)
@pytest.mark.parametrize("eps", [1e-6, 1.0])
@pytest.mark.parametrize("n", [1, 7, 300, BLOCK, BLOCK + 1])
def test_smoothed_sums(rng, n, eps, stretch):
    for name, x, y in clouds(rng, n):
        n_here = len(x)
        shape = STRETCH[stretch]
        rows = None if shape is None else np.tile(shape, (n_here, 1)).T
        for m in weights(rng, n_here):
            contacts = contacts_of(x, y, m, rows)
            v = rng.normal(size=3)
            width = eps * (1.0 + np.hypot(x, y).max())
            table = new_table(n_here)
            smoothed_sums(contacts, three(v), width, table)
            H = agree(contacts, table, v, width)
            # 1 - e e' is a difference, and so is u
            reach = 1.0 + np.hypot(x, y).max()
            size = float(truth(contacts, v, width)[3]) * 4.0 * np.outer(*[[1.0, 1.0, reach]] * 2)
            lost = 1.0 + np.abs(v).max() * reach / width * (name in ("nearly coincident", "tiny"))
            assert np.all(np.abs(full(hessian(table)) - H) <= 1e-14 * lost * size), name


@pytest.mark.parametrize("n", [5, 2000])
def test_exact_sums_leave_out_the_kink(rng, n):
    """The slowest contact nearer than tau, with all at its place; the others are added."""
    found = 0
    for name, x, y in clouds(rng, n):
        if name in ("tiny", "huge"):
            continue
        m = rng.uniform(0.5, 1.0, len(x))
        contacts = contacts_of(x, y, m)
        for motion, v in twists(rng, x, y):
            if "hardly" in motion:
                continue
            tau = 1e-2 * abs(v[2])
            table = new_table(len(x))
            kink, _, _ = exact_sums(contacts, three(v), tau, 1.0, table)
            speeds = np.hypot(v[0] - v[2] * y, v[1] + v[2] * x)
            out = ()
            if kink.contact >= 0:
                found += 1
                j = kink.contact
                assert speeds[j] <= speeds.min() * (1 + 1e-9) + 1e-15 * (1 + abs(v[2]) * 1e4)
                out = np.flatnonzero((x == x[j]) & (y == y[j]))
                assert kink.mass == pytest.approx(m[out].sum())
                assert (kink.x, kink.y) == (x[j], y[j])
            else:
                assert speeds.min() >= tau * (1 - 1e-9)
            rest = np.delete(speeds, out)
            if len(rest) and rest.min() > 1e-6 * np.abs(v).max() * (1 + np.abs(x).max()):
                agree(contacts, table, v, 0.0, out, tol=1e-8)
    assert found > 15


def test_slow_contacts_without_friction_are_no_kink():
    """Only a contact of radius zero is slow: the sums are complete, and nothing is left out."""
    contacts = contacts_of([0.0, 1.0, -2.0], [0.0, 0.5, 0.3], [0.0, 1.0, 2.0])
    table = new_table(3)
    kink, _, _ = exact_sums(contacts, (0.0, 0.0, 1.0), 0.1, 1.0, table)
    assert kink.contact == -1
    assert kink.mass == 0.0
    agree(contacts, table, [0.0, 0.0, 1.0], 0.0)


def test_one_block_is_enough_to_tell_the_kink(rng):
    x, y = rng.normal(size=(2, 5 * BLOCK))
    contacts = contacts_of(x, y, np.ones(len(x)))
    j = 3 * BLOCK + 17
    v = (y[j], -x[j], 1.0)
    assert exact_sums(contacts, v, 1e-9, 1.0, new_table(len(x)))[0].contact == j


def test_coincident_ellipses_are_one_kink_only_if_alike():
    stretch = np.array([[1.0, 0.0, 0.5], [0.5, 0.0, 1.0], [1.0, 0.0, 0.5], [1.0, 0.0, 1.0]]).T
    contacts = contacts_of([0.0, 0.0, 0.0, 1.0], [0.0] * 4, [1.0, 2.0, 4.0, 1.0], stretch)
    kink, _, _ = exact_sums(contacts, (1e-6, 0.0, 1.0), 1e-3, 1.0, new_table(4))
    assert kink.contact == 1
    assert kink.mass == 2.0
    assert kink.stretch == (0.5, 0.0, 1.0)
    assert kink_of(contacts, 0, 5.0).mass == 5.0


def test_threads_give_the_same_bits(rng):
    n = 20 * BLOCK + 5
    x, y = rng.normal(size=(2, n))
    m, v = rng.uniform(0.5, 1.0, n), three(rng.normal(size=3))
    for sums in (
        lambda c, t: smoothed_sums(c, v, 0.1, t),
        lambda c, t: exact_sums(c, v, 0.01, 1.0, t),
    ):
        tables = new_table(n), new_table(n)
        for threads, table in enumerate(tables, 1):
            sums(contacts_of(x, y, m, threads=threads), table)
        assert np.array_equal(*tables)


def test_velocities_and_columns_belong_together(rng):
    x, y = rng.normal(size=(2, 6))
    for stretch in (None, rng.normal(size=(3, 6))):
        contacts = contacts_of(x, y, np.ones(6), stretch)
        v = rng.normal(size=3)
        for i in range(6):
            P = np.array(contact_columns(contacts, i)).T
            assert contact_velocity(contacts, i, three(v)) == pytest.approx(P.T @ v)


def test_second_moments(rng):
    x, y, m = rng.normal(size=(3, 3000))
    for stretch in (None, rng.normal(size=(3, 3000))):
        contacts = contacts_of(x, y, m**2, stretch)
        P = np.array([contact_columns(contacts, i) for i in range(3000)])
        expected = np.einsum("n,nij,nik->jk", m**2, P, P)
        assert full(second_moments(contacts)) == pytest.approx(expected, rel=1e-11, abs=1e-9)


def test_no_contacts():
    contacts, table = contacts_of([], [], []), new_table(0)
    smoothed_sums(contacts, (1.0, 2.0, 3.0), 0.1, table)
    assert not table.any()
    assert exact_sums(contacts, (1.0, 2.0, 3.0), 0.1, 1.0, table)[0].contact == -1


def test_sums_without_the_hessian_are_the_same_sums(rng):
    x, y = rng.normal(size=(2, 3000))
    m = rng.uniform(0.5, 1.0, 3000)
    contacts, full, light = contacts_of(x, y, m), new_table(3000), new_table(3000)
    for tau in (0.0, 0.1):
        kink = exact_sums(contacts, (0.3, -0.2, 1.0), tau, 1.0, full)
        assert exact_sums(contacts, (0.3, -0.2, 1.0), tau, 0.0, light) == kink
        assert light[-1, :4] == pytest.approx(full[-1, :4], rel=1e-13, abs=1e-12)


def test_sums_by_moments_are_the_sums_within_their_error(rng):
    x, y = rng.normal(size=(2, 20000))
    m = rng.uniform(0.5, 1.0, 20000) / 20000
    moments = build_moment_tree(x, y, m, 12)
    data, table = np.stack([moments.x, moments.y, moments.m]), new_table(0)
    direct, v = new_table(20000), (0.3, -0.2, 1.0)
    for tau in (0.0, 0.05):
        kink, error, _ = exact_sums(Contacts(data, 1, Tree(moments, 1e-9)), v, tau, 0.0, table)
        same, _, _ = exact_sums(Contacts(data, 1, None), v, tau, 1.0, direct)
        assert kink.contact == same.contact
        assert 0.0 < error < 1e-7
        assert np.linalg.norm(table[-1, 1:4] - direct[-1, 1:4]) <= error + 1e-13
        assert table[-1, 4:10] == pytest.approx(direct[-1, 4:10], rel=1e-5, abs=1e-5)
