"""The command line."""

from __future__ import annotations

import argparse
import importlib
import sys
from pathlib import Path

from .methods import METHODS, PAIR_METHODS


def importable(names: list[str]) -> tuple[str, ...]:
    """The methods whose libraries can be imported; the others are reported."""
    missing: dict[str, Exception] = {}
    for package in dict.fromkeys(package for name in names for package in METHODS[name].packages):
        try:
            importlib.import_module(package)
        except Exception as error:  # A library that was built for another may raise anything.
            missing[package] = error
    for package, error in missing.items():
        without = ", ".join(name for name in names if package in METHODS[name].packages)
        print(
            f"peers: skipping {without}: {package} can't be imported ({type(error).__name__}: {error})", file=sys.stderr
        )
    return tuple(name for name in names if not missing.keys() & set(METHODS[name].packages))


def main() -> int:
    parser = argparse.ArgumentParser(
        prog="python -m peers",
        description="Runs other libraries' registration and writes OUT/METHOD/NAME.json, one file per answer.",
    )
    what = parser.add_mutually_exclusive_group(required=True)
    what.add_argument("--cases", type=Path, nargs="+", metavar="DIR", help="case folders, or folders of case folders")
    what.add_argument(
        "--pairs", type=Path, metavar="FILE", help='pairs of clouds: [{"id", "source", "target", "voxelSizeM"}]'
    )
    what.add_argument("--self-test", action="store_true", help="recover known motions by every method")
    parser.add_argument("--methods", metavar="A,B,…", help=f"of {', '.join(METHODS)}; by default all that apply")
    parser.add_argument("--out", type=Path, metavar="DIR", help="where the answers go; those that are there are kept")
    parser.add_argument("--jobs", type=int, default=1, metavar="N", help="processes, each on one core, default 1")
    arguments = parser.parse_args()

    known = PAIR_METHODS if arguments.pairs else tuple(METHODS)
    names = arguments.methods.split(",") if arguments.methods else list(known)
    if unknown := [name for name in names if name not in known]:
        parser.error(f"--methods: found {', '.join(unknown)}, expected some of {', '.join(known)}")
    if arguments.jobs < 1:
        parser.error(f"--jobs: found {arguments.jobs}, expected a number from 1")
    if arguments.self_test:
        from .self_test import self_test

        return self_test(names)
    if arguments.out is None:
        parser.error("--out DIR is needed")
    methods = importable(names)
    if not methods:
        return 1

    from .runner import Task, run_tasks

    if arguments.pairs:
        from .pairs import pair_tasks

        tasks = pair_tasks(arguments.pairs, arguments.out, methods)
    else:
        from .case import case_folders

        tasks = [
            Task(folder.resolve().name, arguments.out, methods, folder) for folder in case_folders(arguments.cases)
        ]
    run_tasks(tasks, arguments.jobs)
    return 0


if __name__ == "__main__":
    sys.exit(main())
