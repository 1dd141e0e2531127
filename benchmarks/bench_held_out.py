"""Held-out angles between predicted and true motions, in degrees: measured and simulated pushes.

Measured: the four supports of three feet of Zhou et al. (2016), pairs as they averaged them. 50
pushes a support are split at random; models are fitted to 5, 10, 20 or 30 of them and judged on the
others. "Chosen": `compare_models` sees the training pushes alone, cross-validates the models that
know nothing of the feet, and the one it recommends is fitted to all of them. The mean over
supports and splits, with a 95 % interval over the splits.

Simulated: 100 exact pairs of random motions under `make_support`; 300 others to judge on.

Usage: python benchmarks/bench_held_out.py [--splits 15] [--draws 50] [measured|simulated|actuator]
"""

import argparse
import time

import numpy as np
import pandas as pd
from scipy import stats
from zhou2016 import folder

from limitsurf.contacts.contact_set import ContactSet
from limitsurf.datasets.simulated_supports import SUPPORT_KINDS, make_support
from limitsurf.datasets.simulation import make_sliding_data
from limitsurf.datasets.zhou2016 import RHO, SUPPORTS, load_zhou2016, three_feet
from limitsurf.fitting.actuator_model import ActuatorModel
from limitsurf.fitting.compare_models import compare_models, default_models
from limitsurf.fitting.contact_model import ContactModel
from limitsurf.fitting.ellipsoid_model import EllipsoidModel
from limitsurf.fitting.quartic_model import QuarticModel
from limitsurf.fitting.three_point_model import ThreePointModel

SIZES = (5, 10, 20, 30)
PUBLISHED = {
    "convex quartic": (16.3, 13.5, 12.2, 12.2),
    "plain quartic": (28.7, 17.5, 12.5, 12.0),
    "ellipsoid": (17.4, 15.7, 14.1, 13.7),
    "Gaussian process": (21.0, 17.4, 13.4, 12.3),
}
CHOSEN = "**chosen by cross-validation**"


def measured_pairs():
    """Return loads and displacements (50, 3) of each support."""
    triangles = load_zhou2016(folder(), SUPPORTS)
    return {name: (part.data.loads, part.data.twists) for name, part in triangles.items()}


def split(n, seed):
    """Return the pushes to fit to and those to judge on."""
    order = np.random.default_rng(seed).permutation(50)
    return order[:n], order[n:]


def angle(model, loads, twists):
    """Return the mean angle [deg] of a fitted model."""
    return -np.degrees(model.score(loads, twists))


def errors_of_split(name, loads, twists, n, seed):
    """Return the mean held-out angle [deg] by model, and the name of the one chosen."""
    seen, held = split(n, seed)
    known = three_feet(name).position
    models = default_models(RHO) | {
        "three known feet": ThreePointModel(known, RHO),
        "three known feet, one friction": ThreePointModel(known, RHO, one_friction=True),
    }
    fitted = {key: model.fit(loads[seen], twists[seen]) for key, model in models.items()}
    errors = {key: angle(model, loads[held], twists[held]) for key, model in fitted.items()}
    best = compare_models(loads[seen], twists[seen], rho=RHO).recommended
    return {CHOSEN: errors[best], **errors}, best


def measured(splits):
    """Print the table of the measured pushes, and how often which model was chosen."""
    data = measured_pairs()
    rows, chosen = {}, {}
    for n in SIZES:
        found = []
        for seed in range(splits):
            each = [errors_of_split(name, *data[name], n, seed) for name in SUPPORTS]
            found.append(pd.DataFrame([errors for errors, _ in each]).mean())
            for _, best in each:
                chosen.setdefault(best, dict.fromkeys(SIZES, 0))[n] += 1
        table = pd.DataFrame(found)
        half = stats.t.ppf(0.975, splits - 1) * table.std() / np.sqrt(splits)
        rows[n] = [f"{m:.1f} ± {h:.1f}" for m, h in zip(table.mean(), half, strict=True)]
    print_table(["training pushes", *SIZES], zip(table.columns, *rows.values(), strict=True))
    print_table(["published", *SIZES], [(name, *row) for name, row in PUBLISHED.items()])
    print_table(
        ["chosen, of all splits", *SIZES], [(k, *row.values()) for k, row in chosen.items()]
    )


def simulated(draws):
    """Print the table of exact pairs of simulated supports."""
    models = {"contacts": ContactModel, "quartic": QuarticModel, "ellipsoid": EllipsoidModel}
    rows = []
    for kind in SUPPORT_KINDS:
        errors = np.array([errors_of_draw(kind, seed, models.values()) for seed in range(draws)])
        cells = [f"{e.mean():.2f} (at most {e.max():.2f})" for e in errors.T]
        rows.append((kind, *cells))
    print_table(["support", *models], rows)


def errors_of_draw(kind, seed, models):
    """Return the angles [deg] of models fitted to 100 exact pairs; rho is the feet's gyration."""
    contacts = make_support(kind, seed)
    distances = np.linalg.norm(contacts.position, axis=1)
    rho = float(np.sqrt(np.average(distances**2, weights=contacts.radius)))
    surface = contacts.limit_surface()
    seen, held = (
        make_sliding_data(surface, n, 0.0, draw, rho=rho)
        for n, draw in ((100, seed), (300, 1000 + seed))
    )
    fitted = [model(rho).fit(seen.loads, seen.twists) for model in models]
    return [angle(model, held.loads, held.twists) for model in fitted]


def actuator(draws):
    """Print how well offset and friction of one actuator come back, relative to the friction."""
    tips = np.stack(np.meshgrid(*[np.linspace(-1e-3, 1e-3, 6)] * 2), axis=-1).reshape(-1, 2)
    offset, radius, rho = np.array([2e-8, 0.0]), 6e-8, 7e-4
    array = ContactSet(tips, radius, np.tile(offset, (len(tips), 1))).limit_surface()
    sizes, rows = (10, 30, 100, 300), []
    for noise in (0.0, 0.01, 0.03, 0.1):
        cells = []
        for n in sizes:
            errors = []
            for seed in range(draws):
                rng = np.random.default_rng(seed)
                v = rng.normal(size=(n, 3)) / [1.0, 1.0, rho]
                loads = -array.support_point(-v)
                scale = noise * radius * len(tips) * np.array([1.0, 1.0, rho])
                turned = v + noise * rng.normal(size=(n, 3)) / [1.0, 1.0, rho]
                model = ActuatorModel(tips, rho=rho).fit(
                    loads + scale * rng.normal(size=(n, 3)), turned
                )
                errors.append([*(model.offset_ - offset), model.radius_ - radius])
            shares = np.abs(errors).mean(axis=0) / radius
            cells.append(f"{100 * shares[:2].mean():.2f}, {100 * shares[2]:.2f}")
        rows.append((f"{100 * noise:.0f} %", *cells))
    print_table(["noise", *[f"{n} pushes" for n in sizes]], rows)


def print_table(head, rows):
    """Print a markdown table."""
    print(f"| {' | '.join(map(str, head))} |\n|{'---|' * len(head)}")
    for row in rows:
        print(f"| {' | '.join(map(str, row))} |")
    print(flush=True)


def main():
    """Read the arguments and print the tables asked for."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("tables", nargs="*", default=["measured", "simulated", "actuator"])
    parser.add_argument("--splits", type=int, default=15)
    parser.add_argument("--draws", type=int, default=50)
    options = parser.parse_args()
    start = time.process_time()
    for table in options.tables:
        count = options.splits if table == "measured" else options.draws
        {"measured": measured, "simulated": simulated, "actuator": actuator}[table](count)
    print(f"{time.process_time() - start:.0f} s of processor time")


if __name__ == "__main__":
    main()
