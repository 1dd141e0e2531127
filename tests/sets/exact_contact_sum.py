"""The closest point of a sum of a few contacts in 60 digits, with a certificate of its own.

A twist nearby is polished by Newton's method, as that of a part that is held, that slides, and that
turns about one of its contacts. Which of them is right shows in the certificate: forces in their
disks and any twist bound the square of the error by ``|c - F - Q v|^2 + 2 sum (m |u| - f.u)``.
"""

import mpmath as mp
import numpy as np

DIGITS = 60
_ENOUGH = mp.mpf(10) ** -22


def closest_load(position, radius, load, W, twist):
    """Return the point of ``sum G_i {|f| <= m_i}`` closest to a load, as long doubles.

    `twist` is that of an answer to 1e-6 or so.
    """
    with mp.workdps(DIGITS):
        W = mp.eye(3) if W is None else mp.matrix(np.asarray(W).tolist())
        groups = {}
        for (x, y), m in zip(position, radius, strict=True):
            if m > 0:
                groups[x, y] = groups.get((x, y), mp.mpf(0)) + mp.mpf(float(m))
        contacts = [
            (m, mp.matrix([[1, 0], [0, 1], [-mp.mpf(float(y)), mp.mpf(float(x))]]))
            for (x, y), m in groups.items()
        ]
        c, Q = mp.matrix([mp.mpf(float(a)) for a in load]), mp.inverse(W)
        size = mp.sqrt((c.T * W * c)[0]) + sum((m for m, _ in contacts), mp.mpf(0))
        v = mp.matrix([-mp.mpf(float(a)) for a in twist])
        best = (None, mp.inf)
        for forces, v_exact in _candidates(contacts, Q, c, v, size):
            found = _certificate(contacts, W, Q, c, v_exact, forces)
            best = found if found[1] < best[1] else best
            if best[1] <= _ENOUGH * size:
                return np.array([np.longdouble(mp.nstr(x, 30)) for x in best[0]])
        raise AssertionError(f"not solved: {mp.nstr(best[1], 5)}")


def _certificate(contacts, W, Q, c, v, forces):
    F, gap = mp.matrix([0, 0, 0]), mp.mpf(0)
    for (m, P), f in zip(contacts, forces, strict=True):
        assert mp.norm(f) <= m * (1 + mp.mpf(10) ** -50)
        F += P * f
        gap += m * mp.norm(P.T * v) - (f.T * P.T * v)[0]
    left = c - F - Q * v
    return F, mp.sqrt(abs((left.T * W * left)[0]) + 2 * abs(gap))


def _candidates(contacts, Q, c, v, size):
    zero = mp.zeros(3, 1)
    if mp.norm(v) > 0:
        v_slides = _slides(contacts, Q, c, v, [])
        yield _forces(contacts, v_slides, zero[0]), v_slides
        for j in sorted(range(len(contacts)), key=lambda j: mp.norm(contacts[j][1].T * v))[:4]:
            forces, v_turns = _turns(contacts, Q, c, v, j)
            if forces is not None:
                yield forces, v_turns
    yield _held(contacts, c), zero


def _forces(contacts, v, eps):
    return [m * (P.T * v) / mp.sqrt(mp.norm(P.T * v) ** 2 + eps**2) for m, P in contacts]


def _gradient(contacts, v, eps, out=()):
    g, H = mp.zeros(3, 1), mp.zeros(3)
    for i, (m, P) in enumerate(contacts):
        if i in out:
            continue
        u = P.T * v
        s = mp.sqrt(mp.norm(u) ** 2 + eps**2)
        g += P * u * (m / s)
        H += P * (mp.eye(2) - u * u.T / s**2) * P.T * (m / s)
    return g, H


def _slides(contacts, Q, c, v, out):
    for _ in range(40):
        g, H = _gradient(contacts, v, 0, out)
        step = mp.lu_solve(Q + H, c - Q * v - g)
        v = v + step
        if mp.norm(step) <= mp.mpf(10) ** -52 * mp.norm(v):
            break
    return v


def _turns(contacts, Q, c, v, j):
    """Solve for the rotation w about contact j and the force there."""
    m, P = contacts[j]
    n, w = mp.matrix([-P[2, 0], -P[2, 1], 1]), v[2]
    f = mp.matrix([0, 0])
    for _ in range(40):
        g, H = _gradient(contacts, w * n, 0, [j])
        rest = c - w * Q * n - g - P * f
        A = mp.zeros(3)
        A[:, 0], A[:, 1], A[:, 2] = P[:, 0], P[:, 1], (Q + H) * n
        step = mp.lu_solve(A, rest)
        f, w = f + step[:2, 0], w + step[2]
        if w == 0 or mp.norm(step) <= mp.mpf(10) ** -52 * (abs(w) + m):
            break
    if w == 0 or mp.norm(f) > m:
        return None, v
    forces = [
        f if i == j else k * (R.T * n) * w / mp.norm(R.T * n * w)
        for i, (k, R) in enumerate(contacts)
    ]
    return forces, w * n


def _held(contacts, c):
    """Return forces that balance c: Newton's method on ``sum m sqrt(|u|^2 + 1) - c.v``."""
    v, one = mp.zeros(3, 1), mp.mpf(1)
    scale = max((mp.norm(P[2, :]) for _, P in contacts), default=one)

    def value(v):
        h = sum((m * mp.sqrt(mp.norm(P.T * v) ** 2 + 1) for m, P in contacts), mp.mpf(0))
        return h - (c.T * v)[0]

    for _ in range(60):
        g, H = _gradient(contacts, v, one)
        try:
            step = mp.lu_solve(H, c - g)
        except ZeroDivisionError:
            break
        share, falls = one, ((c - g).T * step)[0]
        while share > 1e-6 and value(v + share * step) > value(v) - share * falls / 10**4:
            share /= 2
        v = v + share * step
        if mp.norm(step) <= mp.mpf(10) ** -50 * (mp.norm(v) + scale) or mp.norm(v) > 1e16:
            break
    return _forces(contacts, v, one)
