"""The command line."""

from __future__ import annotations

import argparse
import importlib
import json
import sys
from pathlib import Path

from .methods import METHODS, PAIR_METHODS
from .runner import Task, run_tasks


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


def pair_tasks(path: Path, out: Path, methods: tuple[str, ...]) -> list[Task]:
    """The tasks of a list [{"id", "source", "target", "voxelSizeM"}]; relative paths start at the list's folder."""
    tasks = []
    for pair in json.loads(path.read_text(encoding="utf-8")):
        source, target = (path.parent / pair[name] for name in ("source", "target"))
        voxel_m = float(pair["voxelSizeM"])
        if not voxel_m > 0:
            raise ValueError(f"{path}: pair {pair['id']}: found voxelSizeM {voxel_m}, expected a number above 0")
        tasks.append(Task(str(pair["id"]), out, methods, source=source, target=target, voxel_m=voxel_m))
    return tasks


def main() -> int:
    parser = argparse.ArgumentParser(
        prog="python -m peers",
        description="Runs other libraries' registration and writes OUT/METHOD/NAME.json, one file per answer.",
    )
    what = parser.add_mutually_exclusive_group(required=True)
    what.add_argument("--cases", type=Path, metavar="DIR", help="a folder of cases as inputs.py reads them")
    what.add_argument(
        "--pairs", type=Path, metavar="FILE", help='pairs of clouds: [{"id", "source", "target", "voxelSizeM"}]'
    )
    parser.add_argument("--methods", metavar="A,B,…", help=f"of {', '.join(METHODS)}; by default all that apply")
    parser.add_argument("--out", type=Path, metavar="DIR", help="where the answers go; those that are there are kept")
    parser.add_argument("--jobs", type=int, default=1, metavar="N", help="processes, each on one core, default 1")
    parser.add_argument("--threads", type=int, default=1, metavar="N", help="of a process, default 1")
    parser.add_argument("--seed", type=int, default=0, metavar="S", help="of the methods' random numbers, default 0")
    arguments = parser.parse_args()

    known = PAIR_METHODS if arguments.pairs else tuple(METHODS)
    names = arguments.methods.split(",") if arguments.methods else list(known)
    if unknown := [name for name in names if name not in known]:
        parser.error(f"--methods: found {', '.join(unknown)}, expected some of {', '.join(known)}")
    if arguments.jobs < 1:
        parser.error(f"--jobs: found {arguments.jobs}, expected a number from 1")
    if arguments.out is None:
        parser.error("--out DIR is needed")
    methods = importable(names)
    if not methods:
        return 1

    if arguments.pairs:
        tasks = pair_tasks(arguments.pairs, arguments.out, methods)
    else:
        folders = sorted(arguments.cases.iterdir())
        tasks = [Task(folder.name, arguments.out, methods, folder) for folder in folders]
    run_tasks(tasks, arguments.jobs, arguments.threads, arguments.seed)
    return 0


if __name__ == "__main__":
    sys.exit(main())
