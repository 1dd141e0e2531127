"""Where the measured pushes of Zhou et al. (ICRA 2016) come from, and where they lie.

`DataError` and `fetch` name source, commit and licence. The checksums are those of the logs whose
averages the library's tests compare with the published ones.
"""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

from limitsurf.errors import DataError, InputError

__all__ = ["LICENCE", "SOURCE", "download", "find_folder", "given_folder", "has_logs"]

_COMMIT = "4d86db9438203f51c4368e5b886def5c402955f3"
SOURCE = f"github.com/robinzhoucmu/MLab_EXP at {_COMMIT}, PushExp/sensor_log"
LICENCE = "Apache-2.0"
_URL = f"https://raw.githubusercontent.com/robinzhoucmu/MLab_EXP/{_COMMIT}/PushExp/sensor_log"

# support: its log in the source, SHA-256
_LOGS = {
    "10_130_10_10_10_130": (
        "exp_08_17_50.txt",
        "f5831f3434a3d46873acec30c65609e0f2e18590868a4118b635ac0973149ee2",
    ),
    "10_90_10_10_30_130": (
        "exp_08_15_50.txt",
        "0d2ef35de2a973c2f3e3a8b005f9c9ebf10aea1383420f1fa44f3f39a401fc67",
    ),
    "30_63.33_43.33_30_43.33_63.33": (
        "exp_08_17_50.txt",
        "7b8c9bedee305a0d89c2fdfb536d432d85046822cbb0bda076d4f6c24185b3da",
    ),
    "30_90_30_30_30_90": (
        "exp_08_11_50_mixed.txt",
        "4fac45796a3a55e98900e09c0db9c1354aed31e36027e120ab0d15aa8211fc1e",
    ),
    "patch": (
        "exp_08_18_1435_50.txt",
        "b5f4bcb6f100ea95dd21e74af190d0d849d2e5303382e01594fd404f6185d517",
    ),
}


def find_folder(path: str | Path | None) -> Path:
    """Return the folder that holds ``logs``: `path`, that of LIMITSURF_DATA, or the cache.

    Raises
    ------
    DataError
        There is none; says where they were looked for and how to get them.
    """
    looked = [given_folder(), _cache()] if path is None else [Path(path)]
    folders = [folder for folder in looked if folder is not None]
    for folder in folders:
        if has_logs(folder):
            return folder
    raise DataError(
        ", ".join(str(folder / "logs") for folder in folders) or "zhou2016",
        "the measured pushes are missing",
        remedy=f"fetch_zhou2016() downloads them ({SOURCE}; {LICENCE}), or set LIMITSURF_DATA to "
        "the folder that holds zhou2016",
    )


def given_folder() -> Path | None:
    """Return the folder that LIMITSURF_DATA gives, which may not exist; None if it gives none."""
    given = os.environ.get("LIMITSURF_DATA")
    return Path(given) / "zhou2016" if given else None


def has_logs(folder: Path) -> bool:
    """Return whether a folder has a folder with logs."""
    return any((folder / "logs").glob("*.txt"))


def download(mirror: str | None = None) -> Path:
    """Return the cache's folder, with the logs in it as their checksums say.

    Raises
    ------
    InputError
        No pooch.
    DataError
        Nothing at the source, or something else than the checksum says.
    """
    pooch = _import_pooch()
    if pooch is None:
        remedy = "pip install 'limitsurf[fit]', or download the logs by hand"
        raise InputError("fetch_zhou2016", "needs pooch", remedy=remedy)
    base = (mirror or _URL).rstrip("/")
    logs = {f"logs/{support}.txt": (support, *log) for support, log in _LOGS.items()}
    store = pooch.create(
        path=pooch.os_cache("limitsurf") / "zhou2016",
        base_url=base,
        registry={name: f"sha256:{checksum}" for name, (_, _, checksum) in logs.items()},
        urls={name: f"{base}/{support}/{log}" for name, (support, log, _) in logs.items()},
        retry_if_failed=1,
    )
    for name in logs:
        try:
            store.fetch(name)
        except (OSError, ValueError) as error:  # requests' errors are OSErrors
            raise DataError(
                store.get_url(name),
                f"cannot be fetched: {error}",
                remedy=f"see {SOURCE}, or set LIMITSURF_DATA to the folder that holds zhou2016",
            ) from error
    return Path(store.path)


def _cache() -> Path | None:
    pooch = _import_pooch()
    return None if pooch is None else Path(pooch.os_cache("limitsurf")) / "zhou2016"


def _import_pooch() -> Any:
    try:
        import pooch
    except ImportError:
        return None
    return pooch
