"""Folders are layers: a file imports only from folders to its left, never from an __init__."""

import ast
from pathlib import Path

import limitsurf

PACKAGE = Path(limitsurf.__file__).parent

LAYERS = [
    {"errors", "tolerances"},
    {"units", "modelfiles"},
    {"kernels", "conic"},
    {"sets"},
    {"geometry"},
    {"contacts"},
    {"actuators"},
    {"motion"},
    {"planning"},
    {"fitting", "datasets"},
    {"plot", "report"},
    {"studies", "sweep", "cli"},
]
RANK = {name: rank for rank, layer in enumerate(LAYERS) for name in layer}

# within a layer, these may import from those
SIDEWAYS = {("tolerances", "errors"), ("modelfiles", "units"), ("report", "plot")}


def imports_of(text):
    """Return the limitsurf modules that a source imports, as dotted names below the package."""
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.ImportFrom) and node.level:
            yield "." * node.level
        elif isinstance(node, ast.ImportFrom) and (node.module or "").startswith("limitsurf"):
            yield node.module.removeprefix("limitsurf").lstrip(".")
        elif isinstance(node, ast.Import):
            for alias in node.names:
                if alias.name.startswith("limitsurf"):
                    yield alias.name.removeprefix("limitsurf").lstrip(".")


def violations(layer, text):
    """Return what is wrong with the imports of a source in a layer."""
    for module in imports_of(text):
        target = module.split(".")[0]
        if module.startswith("."):
            yield "relative import"
        elif target == "":
            if layer not in ("report", "cli"):  # these may ask for the version
                yield "imports the package __init__"
        elif target not in RANK:
            yield f"unknown layer {target}"
        elif target != layer and (RANK[target] >= RANK[layer] and (layer, target) not in SIDEWAYS):
            yield f"{layer} must not import {module}"
        elif (PACKAGE / target).is_dir() and "." not in module:
            yield f"imports the __init__ of {target}"


def layer_of(path):
    return path.relative_to(PACKAGE).parts[0].removesuffix(".py")


def test_every_import_points_down():
    sources = [p for p in PACKAGE.rglob("*.py") if p != PACKAGE / "__init__.py"]
    assert len(sources) > 30
    wrong = [
        f"{path.relative_to(PACKAGE)}: {what}"
        for path in sources
        for what in violations(layer_of(path), path.read_text())
    ]
    assert not wrong, "\n".join(wrong)


def test_every_folder_is_a_layer():
    folders = {p.name for p in PACKAGE.iterdir() if p.is_dir() and p.name != "__pycache__"}
    assert folders - {"models"} <= set(RANK)


def test_an_upward_import_is_found():
    assert list(violations("kernels", "from limitsurf.motion.simulate import simulate"))
    assert list(violations("geometry", "def f():\n    import limitsurf.planning.alignment"))
    assert list(violations("planning", "from limitsurf.kernels import median"))
    assert list(violations("planning", "from . import alignment"))
    assert list(violations("planning", "import limitsurf"))
    assert not list(violations("planning", "from limitsurf.kernels.median import area_left"))
