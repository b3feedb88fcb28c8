"""What a robot reaches from each place of its base."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt


@dataclass(frozen=True, eq=False)
class Placement:
    """What a robot reaches from each place of its base.

    Attributes
    ----------
    bases
        `(P, 7)`: x, y, z of the root link in the world in metres, and its quaternion x, y, z, w.
    targets
        Number of targets.
    in_reach
        `(P,)`: number of targets that some joint state reaches.
    reached
        `(P,)`: number of targets that a joint state reaches without contact.
    states
        `(P,)`: number of these states of all targets: the more, the more room there is for motions.
    """

    bases: npt.NDArray[np.float64]
    targets: int
    in_reach: npt.NDArray[np.int64]
    reached: npt.NDArray[np.int64]
    states: npt.NDArray[np.int64]

    @staticmethod
    def of(bases: npt.NDArray[np.float64], targets: int, batches: Iterable[dict[str, npt.NDArray[Any]]]) -> Placement:
        """Count the answers of a sweep."""
        counts = np.zeros((3, len(bases)), np.int64)
        for batch in batches:
            places = batch["index"] // targets
            for row, values in zip(counts, (batch["solutions"] > 0, batch["free"] > 0, batch["free"]), strict=True):
                np.add.at(row, places, values)
        return Placement(bases, targets, *counts)

    def best(self, count: int = 10) -> npt.NDArray[np.int64]:
        """Return the numbers of the best places: most targets reached, then most states."""
        order: npt.NDArray[np.int64] = np.lexsort((-self.states, -self.reached))[:count]
        return order

    def heading_rad(self, place: int) -> float:
        """Return the direction of the base's x axis seen from above, from the x axis of the world."""
        x, y, z, w = self.bases[place, 3:]
        return float(np.arctan2(2 * (x * y + z * w), 1 - 2 * (y * y + z * z)))

    def __str__(self) -> str:
        """Return the five best places for people."""
        lines = [f"best of {len(self.bases):,} places of the base, {self.targets:,} targets:"]
        for i in self.best(5):
            x, y, z = self.bases[i, :3]
            turn = round(float(np.degrees(self.heading_rad(i)))) % 360
            share = 100 * self.reached[i] / self.targets
            lines.append(f"{i:>6}: x {x:.3f}, y {y:.3f}, z {z:.3f} m, x axis at {turn}°: {self.reached[i]:,} reached ({share:.1f} %)")
        return "\n  ".join(lines)
