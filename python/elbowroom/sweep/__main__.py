"""`python -m elbowroom.sweep TASK.toml [--out DIR] [--executor local|ray]`."""

from __future__ import annotations

import argparse
import importlib.util
import sys
from pathlib import Path

from elbowroom.errors import Error
from elbowroom.sweep import Result, Task, run


def main() -> int:
    """Run the task; 2 for invalid input."""
    parser = argparse.ArgumentParser(prog="elbowroom sweep", description="Answer queries about very many states.")
    parser.add_argument("task", type=Path, help="TOML file of the task")
    parser.add_argument("--out", type=Path, help="folder for the parts and the manifest")
    parser.add_argument("--executor", choices=["local", "ray"], help="where the work is done")
    words = parser.parse_args()
    try:
        result = run(Task.load(words.task), out=words.out, executor=words.executor, progress=True)
    except Error as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print("\nstopped: the same command goes on where it was", file=sys.stderr)
        return 130
    _tell(result)
    return 0


def _tell(result: Result) -> None:
    """Print the result, and draw it where matplotlib is installed."""
    print(result)
    if "base" in result.manifest()["about"]:
        print(result.placement())
    if importlib.util.find_spec("matplotlib"):
        picture = result.folder / "summary.png"
        try:
            result.picture(picture)
        except Error as error:
            print(f"no picture: {str(error).partition(chr(10))[0]}")
        else:
            print(f"picture: {picture}")


if __name__ == "__main__":
    sys.exit(main())
