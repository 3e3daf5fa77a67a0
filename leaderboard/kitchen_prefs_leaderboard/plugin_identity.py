"""Which code a policy from elsewhere has: its package is looked at and never imported."""

import hashlib
import sys
from collections.abc import Iterator
from importlib.machinery import PathFinder
from importlib.metadata import distributions
from importlib.util import find_spec
from pathlib import Path

from kitchen_prefs_leaderboard.submission_format import Plugin


def find_plugin(package: str, plugins: Path | None = None) -> Plugin:
    """Find an installed plug-in, also an editable one.

    Args:
        package: Its package. LeRobot imports the package that has the name of its distribution.
        plugins: A folder of packages that is looked at first.

    Raises:
        ValueError: If it is not installed.
    """
    path = [*([str(plugins)] if plugins else []), *sys.path]
    named = distributions(name=package, path=path) if package.isidentifier() else ()
    found = next(iter(named), None)
    # Some editable installations bring a finder of their own, which `find_spec` asks.
    spec = found and (PathFinder.find_spec(package, path) or find_spec(package))
    folders = spec and spec.submodule_search_locations
    if not (found and folders):
        raise ValueError(f"The policy's package {package!r} is not installed; install it here.")
    return Plugin(
        distribution=found.metadata["Name"],
        version=found.version,
        code=_code_hash(Path(next(iter(folders)))),
    )


def _code_hash(package: Path) -> str:
    """A hash of a package's files: their paths and bytes, in order, without bytecode."""
    sha = hashlib.sha256()
    for name, file in sorted(_files(package)):
        content = file.read_bytes()
        sha.update(f"{name} {len(content)}\n".encode())
        sha.update(content)
    return sha.hexdigest()


def _files(package: Path) -> Iterator[tuple[str, Path]]:
    for file in package.rglob("*"):
        name = file.relative_to(package)
        if file.is_file() and "__pycache__" not in name.parts:
            yield name.as_posix(), file
