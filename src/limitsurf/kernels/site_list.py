"""A list of lattice sites that changes at the cost of the change: swap-remove and a hash table.

Sites are kept without gaps in the first entries of an array. A table with open addressing says
where a site is: entry h holds a place in the array, -1 if it is free; a site is found at or after
its own entry. Removing a site moves later ones up, so that no search meets a gap (Knuth, *The Art
of Computer Programming* 3, 6.4, algorithm R).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from limitsurf.kernels.compile import Ints, compiled

__all__ = ["SiteList", "change_sites", "new_site_list"]


class SiteList(NamedTuple):
    """Room for sites (capacity, 2) ``row, column``, and the table, a power of two in size."""

    sites: Ints
    table: Ints


@compiled
def new_site_list(capacity: int) -> SiteList:
    """Return an empty list with room for `capacity` sites; its table is at most half full."""
    size = 16
    while size < 2 * capacity:
        size *= 2
    return SiteList(np.empty((capacity, 2), np.int32), np.full(size, -1, np.int32))


@compiled
def _own_entry(row: int, column: int, size: int) -> int:
    """Return where in the table to look for a site first."""
    mixed = (row * 73856093) ^ (column * 19349663)
    mixed = (mixed ^ (mixed >> 15)) * 0x2C1B3C6D
    return (mixed ^ (mixed >> 13)) & (size - 1)


@compiled
def _find(items: SiteList, row: int, column: int) -> int:
    """Return the entry of a site in the table, or the free one where it would go."""
    sites, table = items.sites, items.table
    h = _own_entry(row, column, table.shape[0])
    while table[h] >= 0 and not (sites[table[h], 0] == row and sites[table[h], 1] == column):
        h = (h + 1) & (table.shape[0] - 1)
    return h


@compiled
def _free_entry(items: SiteList, h: int) -> None:
    """Free an entry of the table and move up those that a search would no longer reach."""
    sites, table = items.sites, items.table
    last = table.shape[0] - 1
    table[h] = -1
    j = (h + 1) & last
    while table[j] >= 0:
        own = _own_entry(sites[table[j], 0], sites[table[j], 1], table.shape[0])
        if ((j - own) & last) >= ((j - h) & last):
            table[h], table[j] = table[j], -1
            h = j
        j = (j + 1) & last


@compiled
def change_sites(items: SiteList, count: int, entered: Ints, left: Ints) -> int:
    """Remove the sites `left` (k, 2), add `entered`, and return the new number of sites.

    Those must be in the list, these not, and there must be room. The last site of the list takes
    the place of one that is removed.
    """
    sites, table = items.sites, items.table
    for k in range(left.shape[0]):
        h = _find(items, left[k, 0], left[k, 1])
        place = table[h]
        _free_entry(items, h)
        count -= 1
        if place != count:
            table[_find(items, sites[count, 0], sites[count, 1])] = place
            sites[place] = sites[count]
    for k in range(entered.shape[0]):
        table[_find(items, entered[k, 0], entered[k, 1])] = count
        sites[count] = entered[k]
        count += 1
    return count
