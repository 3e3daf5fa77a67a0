"""The OpenGL context that MuJoCo draws in, with or without a display."""

import os
import sys
from typing import Any


class NoOpenGLError(OSError):
    """Nothing can be drawn on this machine; the message says what to install."""

    def __init__(self) -> None:
        super().__init__(
            "Pictures need an OpenGL library that draws without a display: on Debian or Ubuntu, "
            "`apt install libegl1 libegl-mesa0 libgl1-mesa-dri`. Everything but pictures works "
            "without it."
        )


def open_context(width: int, height: int) -> Any:
    """Open a context, and make it the current one.

    `MUJOCO_GL` is obeyed where it is set. Without it and without a display MuJoCo would fail, so
    EGL draws then, in software if need be.

    Args:
        width: Of the pictures, in pixels.
        height: Of the pictures, in pixels.

    Returns:
        A context with the methods `make_current` and `free`.

    Raises:
        NoOpenGLError: If there is no library to draw with.
    """
    headless = sys.platform == "linux" and not os.environ.get("DISPLAY")
    try:
        if headless and not os.environ.get("MUJOCO_GL"):
            from mujoco.egl import GLContext
        else:
            from mujoco.gl_context import GLContext
        context = GLContext(width, height)
        context.make_current()
    except (ImportError, RuntimeError, AttributeError) as error:
        # PyOpenGL says AttributeError where the library is missing.
        raise NoOpenGLError from error
    return context
