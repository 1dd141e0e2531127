"""Mean friction of 1e5 oscillating tips beside a NumPy loop over the tips, in one run.

Potential, gradient and Hessian, waveforms of 64 samples. The loop treats the 64 pieces of a tip
in NumPy arrays, by the text-book antiderivatives; it takes a share of the tips and is scaled up.

Usage: python benchmarks/bench_oscillating.py
"""

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np
from timing import timed

from limitsurf.contacts.oscillating_contact import OscillatingContact
from limitsurf.kernels.oscillating import SUMS, tip_sums

TIPS, SAMPLES, LOOPED = 100_000, 64, 2000


def tips_and_velocities(rng):
    """Return tips with two harmonics, pressing unevenly, and a velocity for each."""
    phase = np.arange(SAMPLES) / SAMPLES + rng.uniform(0, 1, (TIPS, 1))
    w = np.sin(2 * np.pi * phase) + 0.3 * np.sin(4 * np.pi * phase + 1.0)
    N = 1.0 + 0.8 * np.cos(2 * np.pi * phase)
    tips = OscillatingContact(0.4, rng.normal(size=(TIPS, 2)), w, N)
    return tips, rng.normal(size=(TIPS, 2))


def one_tip(u, e, w, N):
    """Return the six numbers of a tip by differences of antiderivatives over its pieces."""
    p, q = u @ e, u[1] * e[0] - u[0] * e[1]
    x = w - p
    r = np.sqrt(x * x + q * q)
    log = np.arcsinh(x / abs(q))
    one = np.stack([0.5 * (x * r + q * q * log), r, log, x / r, -1.0 / r])
    more = np.stack([r**3 / 3, 0.5 * (x * r - q * q * log), r, -q * q / r, log - x / r])
    d = np.roll(x, -1) - x
    one, more = ((np.roll(f, -1, axis=1) - f) / d for f in (one, more))
    slope = (np.roll(N, -1) - N) / d
    base = N - slope * x
    phi, gp, j, hpp, hpq = (base * one + slope * more) @ np.full(len(w), 1.0 / len(w))
    gq, hpq, hqq = q * j, q * hpq, j - hpp
    R = np.array([[e[0], -e[1]], [e[1], e[0]]])
    H = R @ np.array([[hpp, hpq], [hpq, hqq]]) @ R.T
    return np.array([phi, *(R @ [-gp, gq]), H[0, 0], H[0, 1], H[1, 1]])


def main():
    """Print times for all tips, the ratio, and how far the two differ."""
    tips, u = tips_and_velocities(np.random.default_rng(0))
    e, w, N = tips.direction.copy(), tips.tip_velocity.copy(), tips.mu[:, None] * tips.normal_force
    which = np.arange(TIPS, dtype=np.int32)
    out = np.empty((TIPS, SUMS))
    tip_sums(u[:1], which[:1], e, w, N, 1e-6, 0.0, False, out)
    kernel, _ = timed(lambda: tip_sums(u, which, e, w, N, 1e-6, 0.0, False, out))
    tips.moving_sums(u)
    whole, _ = timed(lambda: tips.moving_sums(u))
    loop, slow = timed(
        lambda: np.array([one_tip(u[i], e[i], w[i], N[i]) for i in range(LOOPED)]), 3
    )
    loop *= TIPS / LOOPED
    scale = np.abs(out[:LOOPED]).max(axis=1, keepdims=True)
    gap = np.median(np.abs(slow - out[:LOOPED]) / scale)
    drift, _ = timed(lambda: tips[: TIPS // 10].drift_velocity, 1)
    print(f"{TIPS} tips, {SAMPLES} samples: Phi, gradient and Hessian\n")
    print("| NumPy loop over tips, s | kernel, s | ratio | OscillatingContact, s | ratio |")
    print("|---|---|---|---|---|")
    print(f"| {loop:.2f} | {kernel:.4f} | {loop / kernel:.0f} | {whole:.4f} | {loop / whole:.0f} |")
    print(f"\nmedian difference of the two: {gap:.0e} (the loop's own cancellation)")
    print(f"drift velocities of {TIPS // 10} tips: {drift:.3f} s")


if __name__ == "__main__":
    main()
