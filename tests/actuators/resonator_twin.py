"""Slow twins of the resonator: the balance by quadrature and SciPy, and time-stepping."""

import numpy as np
from numba import njit
from scipy.constants import epsilon_0
from scipy.optimize import brentq, root

LEGENDRE = np.polynomial.legendre.leggauss(40)


def drives(resonator, voltage, phase):
    """Return V(t)^2 of the left and right side at a phase of the torque's cosine."""

    def square(x):
        wave = np.cos(x / 2) if resonator.drive == "sine" else 0.5 * (1 + np.cos(x))
        return voltage**2 * wave**2

    left = square(phase) if resonator.driven in ("-x", "both") else 0 * phase
    right = square(phase + np.pi) if resonator.driven in ("+x", "both") else 0 * phase
    return left, right


def rim_torque(resonator, tilt, left, right):
    """Return the torque for V^2 on either side, by Gauss points along the strips."""
    x, w = LEGENDRE
    total = 0.0
    for lever, square, sign in zip(resonator.levers, (right, left), (-1.0, 1.0), strict=True):
        gap = resonator.clearance - sign * lever * tilt
        spots = 0.5 * lever * (x + 1)
        gaps = resonator.clearance - sign * np.multiply.outer(tilt, spots)
        strips = 2 * (0.5 * lever * w * spots / gaps**2).sum(axis=-1)
        arms = resonator.grid_length * lever / gap**2 + strips
        total = total + sign * 0.5 * epsilon_0 * resonator.effective_width * square * arms
    return total


def contact_averages(resonator, height, tilt, swing, omega, mu):
    """Return mean N, the torque's averages times 1, 2 cos, 2 sin, and mean N sign(w)."""
    out = np.zeros(5)
    K, C = resonator.contact_stiffness, resonator.contact_damping
    for sign, lever, top in zip((1.0, -1.0), resonator.levers, resonator.tip_heights, strict=True):
        middle, reach = top + sign * lever * tilt - height, lever * swing
        if middle + reach <= 0.0:
            continue
        alpha = np.arccos(max(-middle / reach, -1.0))

        def pull(psi, middle=middle, reach=reach):  # psi from the tip's own peak
            return K * (middle + reach * np.cos(psi)) - C * reach * omega * np.sin(psi)

        end = brentq(pull, 0.0, alpha + 1e-12) if C > 0.0 else alpha
        for low, high in ((-alpha, 0.0), (0.0, end)):
            psi = 0.5 * (high - low) * (LEGENDRE[0] + 1) + low
            p = psi + sign * 0.5 * np.pi
            share = 1.0 if low < 0.0 else resonator.restitution
            N = share * pull(psi) * 0.5 * (high - low) * LEGENDRE[1] / (2 * np.pi)
            turning = np.sign(np.cos(p))
            arm = sign * lever + mu * top * turning
            weights = np.ones_like(p), arm, 2 * np.cos(p) * arm, 2 * np.sin(p) * arm, -turning
            out += [(N * weight).sum() for weight in weights]
    return out


def height_for(resonator, load, tilt, swing, omega, mu):
    """Return the height at which the tips carry the load."""
    ends = zip((1.0, -1.0), resonator.levers, resonator.tip_heights, strict=True)
    top = max(high + lever * (sign * tilt + swing) for sign, lever, high in ends)

    def excess(height):
        return contact_averages(resonator, height, tilt, swing, omega, mu)[0] - load

    return brentq(excess, top - 1.9 * min(resonator.levers) * swing, top, xtol=1e-20)


def twin_floating(resonator, load, voltage, mu, lag=0.5 * np.pi):
    """Return (tilt amplitude, mean tilt, omega, height, offset over mu load)."""
    phase = 2 * np.pi * np.arange(256) / 256
    k, j, c = resonator.stiffness, resonator.inertia, resonator.damping
    natural = np.sqrt(k / j)
    left, right = drives(resonator, voltage, phase + lag - 0.5 * np.pi)
    linear = rim_torque(resonator, np.zeros(256), left, right)
    cos, sin = 2 * (linear * np.cos(phase)).mean(), 2 * (linear * np.sin(phase)).mean()
    first = max(np.roots([j, c * sin / cos, -k]))  # omega of the linear oscillator
    scale = cos / (c * first)

    def balance(x, carried=0.0):
        swing, tilt, omega = x[0] * scale, x[1] * scale, x[2] * natural
        torque = rim_torque(resonator, tilt + swing * np.sin(phase), left, right)
        cos, sin = 2 * (torque * np.cos(phase)).mean(), 2 * (torque * np.sin(phase)).mean()
        part = np.zeros(5)
        if carried > 0.0:
            height = height_for(resonator, carried, tilt, swing, omega, mu)
            part = contact_averages(resonator, height, tilt, swing, omega, mu)
        return [
            (k * tilt - torque.mean() + part[1]) / (k * scale),
            (c * omega * swing - cos + part[2]) / (c * natural * scale),
            ((k - j * omega**2) * swing - sin + part[3]) / (k * scale),
        ]

    x = root(balance, [1.0, 0.0, first / natural], tol=1e-12).x
    for share in np.linspace(0.0, 1.0, max(2, int(np.ceil(load / 2e-8)) + 1))[1:]:
        x = root(balance, x, args=(share * load,), tol=1e-12).x  # load by load: Newton stays near
    state = x[1] * scale, x[0] * scale, x[2] * natural
    height = height_for(resonator, load, *state, mu)
    part = contact_averages(resonator, height, *state, mu)
    return x[0] * scale, x[1] * scale, x[2] * natural, height, part[4] / load


@njit
def _march(theta, rate, dt, steps, per, p):
    """March J th'' + c th' + k th = tau - sum N (x + mu z sign th') by classical Runge-Kutta."""
    (k, j, c, strength, length, gap, omega, height, K, C, mu) = p[:11]
    levers, tops, on, biased, ahead = p[11:13], p[13:15], p[15:17], p[17], p[18]
    low, high, normal, push, count = np.inf, -np.inf, 0.0, 0.0, 0
    state = np.array([theta, rate])
    slopes = np.empty((4, 2))
    for n in range(steps):
        for stage in range(4):
            h = 0.0 if stage == 0 else (dt if stage == 3 else 0.5 * dt)
            th = state[0] + h * (slopes[stage - 1, 0] if stage else 0.0)
            om = state[1] + h * (slopes[stage - 1, 1] if stage else 0.0)
            t = n * dt + h
            torque, total = 0.0, 0.0
            for side in range(2):
                sign = 1.0 if side == 0 else -1.0
                R = levers[side]
                x = omega * t + ahead + (np.pi if side == 0 else 0.0)
                wave = 0.5 * (1.0 + np.cos(x))
                square = wave**2 if biased > 0.0 else wave
                u = sign * R * th / gap
                strip = (np.log1p(u) - u / (1 + u)) / u**2 if abs(u) > 1e-3 else 0.5 - 2 * u / 3
                torque -= (
                    sign
                    * on[side]
                    * strength
                    * square
                    * R
                    / gap**2
                    * (length / (1 + u) ** 2 + 2 * R * strip)
                )
                inside = tops[side] + sign * R * th - height
                if inside > 0.0:
                    N = max(K * inside + C * sign * R * om, 0.0)
                    total += N
                    torque -= N * (sign * R + mu * tops[side] * np.sign(om))
            slopes[stage, 0] = om
            slopes[stage, 1] = (torque - c * om - k * th) / j
            if stage == 0 and n >= steps - 20 * per:
                low, high, count = min(low, th), max(high, th), count + 1
                normal += total
                push -= total * np.sign(om)
        state = state + dt / 6.0 * (slopes[0] + 2 * slopes[1] + 2 * slopes[2] + slopes[3])
    return 0.5 * (high - low), 0.5 * (high + low), normal / count, push / normal


def march(part, cycles=400, per=400):
    """Return tilt amplitude, mean tilt, mean N and offset fraction, many cycles on."""
    resonator, voltage, omega = part.resonator, part.voltage, 2 * np.pi * part.frequency
    strength = 0.5 * epsilon_0 * resonator.effective_width * voltage**2
    sides = [float(resonator.driven in (s, "both")) for s in ("+x", "-x")]
    p = np.array(
        [
            resonator.stiffness,
            resonator.inertia,
            resonator.damping,
            strength,
            resonator.grid_length,
            resonator.clearance,
            omega,
            part.height,
            resonator.contact_stiffness,
            resonator.contact_damping,
            part.mu,
            *resonator.levers,
            *resonator.tip_heights,
            *sides,
            float(resonator.drive == "biased"),
            part.lag - 0.5 * np.pi,
        ]
    )
    dt = 2 * np.pi / omega / per
    return _march(part.mean_tilt, part.tilt_amplitude * omega, dt, cycles * per, per, p)
