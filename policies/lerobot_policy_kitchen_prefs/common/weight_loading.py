"""Weights that do not fit their policy's settings, said in one sentence."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path


@contextmanager
def misfit_in_a_sentence(path: str | Path) -> Iterator[None]:
    """Replaces torch's list of all shapes that do not fit.

    Args:
        path: Where the weights are.

    Raises:
        RuntimeError: If weights that are loaded inside have other shapes than the policy.
    """
    try:
        yield
    except RuntimeError as error:
        if "size mismatch" not in str(error):
            raise
        raise RuntimeError(
            f"The weights in {path} have other shapes than the policy's settings ask for; leave "
            "out the --policy settings that change its size."
        ) from None
