"""Progress on standard error: how much is done, rate, time that is left."""

from __future__ import annotations

import sys
import time


class Progress:
    """One line that is written again at most twice a second; silent if it is not wanted."""

    def __init__(self, wanted: bool, rows: int, done: int = 0, unit: str = "rows") -> None:
        """Start with what was done before, as in an interrupted sweep."""
        self._wanted = wanted
        self._rows = rows
        self._unit = unit
        self._done = done
        self._before = done
        self._begun = self._shown = time.monotonic()

    def add(self, rows: int) -> None:
        """Count what is finished."""
        self._done += rows
        now = time.monotonic()
        if self._wanted and (now - self._shown > 0.5 or self._done == self._rows):
            self._shown = now
            rate = (self._done - self._before) / max(now - self._begun, 1e-9)
            left = (self._rows - self._done) / max(rate, 1e-9)
            text = f"\r{self._done:,} of {self._rows:,} {self._unit}, {rate:,.0f} per second, {_duration(left)} left"
            print(f"{text:<78}", end="", file=sys.stderr, flush=True)

    def end(self) -> None:
        """End the line."""
        if self._wanted and self._done:
            print(file=sys.stderr)


def _duration(seconds: float) -> str:
    minutes, s = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours} h {minutes:02} min" if hours else f"{minutes} min {s:02} s" if minutes else f"{s} s"
